# SPDX-License-Identifier: BSD-3-Clause
"""The lines of docs/paraview.md run as they stand, and its pictures show what the page says. PICTURES in the environment: a folder that keeps them."""
import os
import pathlib
import re
import shutil
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import numpy as np
from host import SOURCE, WORK, check, finish
from paraview.vtk.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOImage import vtkPNGReader

PAGE = SOURCE / "docs/paraview.md"
PICTURES = SOURCE / "docs/pictures"


def picture(file):
    reader = vtkPNGReader()
    reader.SetFileName(str(file))
    reader.Update()
    image = reader.GetOutput()
    width, height = image.GetExtent()[1] + 1, image.GetExtent()[3] + 1
    return vtk_to_numpy(image.GetPointData().GetScalars()).reshape(height, width, -1)[::-1, :, :3].astype(float)


def small(image, cells=24):
    """Means over a grid: what the eye sees from afar, whatever the drawing library does at edges."""
    h, w = (n // cells * cells for n in image.shape[:2])
    return image[:h, :w].reshape(cells, h // cells, cells, w // cells, 3).mean(axis=(1, 3))


def main():
    blocks = re.findall(r"^```python\n(.*?)^```", PAGE.read_text(encoding="utf-8"), re.M | re.S)
    check(len(blocks) >= 5, f"only {len(blocks)} blocks of Python in the page")
    os.chdir(WORK)
    for name in "plugins", "sessions":  # the project's folder, seen from an empty one
        os.symlink(SOURCE / name, WORK / name)
    names = {}
    for block in blocks:
        exec(compile(block, "docs/paraview.md", "exec"), names)
    drawn = sorted(pathlib.Path(WORK).glob("paraview-*.png"))
    check([f.name for f in drawn] == ["paraview-errors.png", "paraview-predict.png", "paraview-scene.png", "paraview-through.png"], f"pictures: {drawn}")
    for file in drawn:
        image = picture(file)
        check(image.std() > 5, f"{file.name}: is not blank")
        if os.environ.get("PICTURES"):
            shutil.copy(file, os.environ["PICTURES"])
            continue
        stored = picture(PICTURES / file.name)
        check(stored.shape == image.shape, f"{file.name}: size {image.shape}")
        off = np.abs(small(stored) - small(image))
        check(off.max() < 12, f"{file.name}: a cell of 24 x 24 differs from the stored picture by {off.max():.1f} of 255")


main()
finish()
