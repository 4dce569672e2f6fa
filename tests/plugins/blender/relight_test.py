# SPDX-License-Identifier: BSD-3-Clause
"""The example of relighting, on photographs that `glint synth` made: Cycles draws the highlight that Glint found where Glint drew it."""
import importlib.util
import math
import os
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import host


class Relight(unittest.TestCase):
    def test_rendered_highlight_lies_on_the_photographed_one(self):
        file = os.path.join(host.ROOT, "plugins", "blender", "examples", "relight.py")
        spec = importlib.util.spec_from_file_location("relight", file)
        relight = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(relight)
        out = os.path.join(host.folder("out"), "relit.png")
        scene = os.path.join(host.ROOT, "sessions", "ellipsoid", "scene.json")
        found = relight.main([scene, "0010", out, "--glint", host.GLINT, "--work", host.folder("work"), "--train", "spread:6", "--samples", "4"])
        # The truth of sessions/ellipsoid/spec.json: a Torrance-Sparrow lobe of 0.1 and a lamp at (1.2, -1, 2.2).
        self.assertEqual(found["lobe"], "torrance-sparrow")
        self.assertLess(abs(found["roughness"] - 0.1), 0.002)
        self.assertLess(math.dist(found["light_position"][:3], (1.2, -1.0, 2.2)), 0.02)
        self.assertLess(found["peak_offset_px"], 0.5)  # facets of the mesh, four samples: measured 0.28
        self.assertLess(found["rms_codes"], 3)
        self.assertEqual(relight.pixels_of(out).shape[:2], (480, 3 * 640))


if __name__ == "__main__":
    host.main()
