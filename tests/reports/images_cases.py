# SPDX-License-Identifier: BSD-3-Clause
"""Cases of run.py: images as other programs write them. Errors are those of the same pixels in a plain file."""
import json
import struct
import zlib

from run import lacks, near, says

WHOLE = {"limit-angle": 0.7935, "canonical": 1.6744}  # of the same capture without the fault (README of each folder)
PNG = b"\x89PNG\r\n\x1a\n"


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def pixels_of(png):
    """Rows of pixels (bytes) of a PNG of 8 bits without interlacing."""
    at, data = len(PNG), b""
    while at < len(png):
        length, kind = struct.unpack(">I4s", png[at:at + 8])
        if kind == b"IHDR":
            width, height, bits, colours = struct.unpack(">IIBB", png[at + 8:at + 18])
        if kind == b"IDAT":
            data += png[at + 8:at + 8 + length]
        at += 12 + length
    each = {0: 1, 2: 3, 6: 4}[colours]
    assert bits == 8
    data, stride = zlib.decompress(data), width * each
    before, rows = bytearray(stride), []
    for y in range(height):
        way, row = data[y * (stride + 1)], bytearray(data[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        for i in range(stride):
            left, up, corner = (row[i - each] if i >= each else 0), before[i], (before[i - each] if i >= each else 0)
            near_ = min((left, up, corner), key=lambda v: abs(left + up - corner - v))
            row[i] = (row[i] + (0, left, up, (left + up) // 2, near_)[way]) & 255
        rows.append([bytes(row[i:i + each]) for i in range(0, stride, each)])
        before = row
    return rows


def png_of(rows, orientation):
    """With EXIF data that say how a viewer turns it."""
    colours = {1: 0, 3: 2, 4: 6}[len(rows[0][0])]
    exif = b"II*\0" + struct.pack("<IHHHIHHI", 8, 1, 0x0112, 3, 1, orientation, 0, 0)
    data = b"".join(b"\0" + b"".join(row) for row in rows)
    return (PNG + chunk(b"IHDR", struct.pack(">IIBBBBB", len(rows[0]), len(rows), 8, colours, 0, 0, 0)) + chunk(b"eXIf", exif)
            + chunk(b"IDAT", zlib.compress(data, 1)) + chunk(b"IEND", b""))


def exr_of(width, height, channels):
    """An EXR without compression. `channels`: name -> rows of floats."""
    def attribute(name, kind, data):
        return name + b"\0" + kind + b"\0" + struct.pack("<I", len(data)) + data
    names = sorted(channels)
    listed = b"".join(n.encode() + b"\0" + struct.pack("<IIII", 2, 0, 1, 1) for n in names) + b"\0"
    box = struct.pack("<IIII", 0, 0, width - 1, height - 1)
    head = (b"\x76\x2f\x31\x01\x02\0\0\0" + attribute(b"channels", b"chlist", listed) + attribute(b"compression", b"compression", b"\0")
            + attribute(b"dataWindow", b"box2i", box) + attribute(b"displayWindow", b"box2i", box) + attribute(b"lineOrder", b"lineOrder", b"\0")
            + attribute(b"pixelAspectRatio", b"float", struct.pack("<f", 1)) + attribute(b"screenWindowCenter", b"v2f", bytes(8))
            + attribute(b"screenWindowWidth", b"float", struct.pack("<f", 1)) + b"\0")
    rows = [struct.pack("<II", y, 4 * width * len(names)) + b"".join(struct.pack(f"<{width}f", *channels[n][y]) for n in names) for y in range(height)]
    first = len(head) + 8 * height
    return head + b"".join(struct.pack("<Q", first + y * len(rows[0])) for y in range(height)) + b"".join(rows)


def case_tiff_planar_16_bit(report):
    near(report.errors(models="limit-angle", train="first:4"), {"limit-angle": 2.0232})
    found = json.loads(report.glint("detect", ".", "--json", "-").stdout)
    assert [len(frame["highlights"]) for frame in found["frames"]] == [1] * 5, found


def case_tiff_half_float(report):
    near(report.errors(models="limit-angle", train="first:4"), {"limit-angle": 1.8607})


def case_tiff_bigtiff(report):
    near(report.errors(models="limit-angle", train="first:4"), {"limit-angle": 1.9317})


def case_raw_files(report):
    found = report.info()
    says(found, "raw file of a camera", "develop it to TIFF or PNG first")
    lacks(found, "damaged", "truncated")
    report.folder.joinpath("images/a.dng").write_bytes(report.folder.joinpath("images/b.CR2").read_bytes())
    found = report.info()
    says(found, "raw file of a camera")
    lacks(found, "damaged", "truncated")


def case_exif_rotated_size(report):
    """Applied, as it makes the sizes agree."""
    near(report.errors(), WHOLE, within=0.1)  # a JPEG's noise is another one
    found = report.info()
    says(found, "turned by its EXIF orientation 6, with which the sizes agree")
    lacks(found, "cannot be used")


def case_exif_rotated_size__other_size(report):
    """A tag that does not make the sizes agree says nothing."""
    text = (report.folder / "scene.json").read_text()
    (report.folder / "scene.json").write_text(text.replace('"width": 320', '"width": 321'))
    assert '"width": 321' in (report.folder / "scene.json").read_text()
    says(report.glint("evaluate", ".", "--models", "limit-angle", exit_code=3).stderr, "240 x 320 pixels, the camera 321 x 240")


def case_path_case__turned_by_exif(report):
    """The four quarter turns of the EXIF standard: stored rows and columns of a picture that a viewer shows upright."""
    images = sorted((report.folder / "images").iterdir())
    upright = [pixels_of(image.read_bytes()) for image in images]
    for orientation in (5, 6, 7, 8):
        for image, rows in zip(images, upright):
            columns = [list(column) for column in zip(*rows)]  # 5: the first row is the left side, the first column the top
            if orientation in (6, 7):  # the first row is the right side
                columns.reverse()
            if orientation in (7, 8):  # the first column is the bottom
                columns = [column[::-1] for column in columns]
            image.write_bytes(png_of(columns, orientation))
        near(report.errors(), WHOLE)


def case_exr_multilayer(report):
    found = json.loads(report.glint("detect", ".", "--json", "-").stdout)
    assert [len(frame["highlights"]) for frame in found["frames"]] == [1] * 3, found


def case_exr_multilayer__depth_beside_colours(report):
    """Blender's Combined and Depth in one file: the depth where depth is asked for. The same numbers as with the depth in a file of its own."""
    scene = json.loads((report.folder / "scene.json").read_text())
    width, height = scene["camera"]["width"], scene["camera"]["height"]
    plane = [[2 + 0.01 * x + 0.02 * y for x in range(width)] for y in range(height)]
    grey = [[0.5] * width] * height
    for frame in scene["frames"]:
        frame.update(depth="depth.exr", surface=next(iter(scene["surfaces"])))
    (report.folder / "scene.json").write_text(json.dumps(scene))
    kinds = {"alone": {"Z": plane}, "beside": {"R": grey, "G": grey, "B": grey, "Z": plane}, "grey": {"Y": grey, "Z": plane},
             "layers": {"ViewLayer.Combined.R": grey, "ViewLayer.Combined.G": grey, "ViewLayer.Combined.B": grey, "ViewLayer.Depth.Z": plane},
             "volume": {"R": grey, "G": grey, "B": grey, "Depth.V": plane}, "equal": {"R": plane, "G": plane, "B": plane}}
    answers = {}
    for name, channels in kinds.items():
        (report.folder / "depth.exr").write_bytes(exr_of(width, height, channels))
        facts = json.loads(report.glint("info", ".", "--json", "-").stdout)
        assert not any("cannot be used" in line for line in facts["findings"]), (name, facts["findings"])
        answers[name] = [f["depth_difference_m"] for f in facts["frames"]]
    assert answers["alone"][0]["samples"] > 0 and all(a == answers["alone"] for a in answers.values()), answers
    (report.folder / "depth.exr").write_bytes(exr_of(width, height, {"R": grey, "G": plane, "B": grey}))
    says(report.info(), "needed is one of depth, Z or V")


NOT_READ = {"a HEIC picture": b"\0\0\0\x18ftypheic\0\0\0\0mif1heic", "an AVIF picture": b"\0\0\0\x1cftypmif1\0\0\0\0mif1avif", "a GIF picture": b"GIF89a",
            "a JPEG XL picture": b"\xff\x0a", "a JPEG 2000 picture": b"\0\0\0\x0cjP  \r\n\x87\n", "a Photoshop picture": b"8BPS\0\1"}


def case_raw_files__other_kinds(report):
    for words, start in NOT_READ.items():
        for image in (report.folder / "images").iterdir():
            image.write_bytes(start + bytes(range(256)) * 8)
        found = report.info()
        says(found, words, "convert it")
        lacks(found, "damaged", "truncated")


def grey_tiff(width, height, bits, kind, samples):
    entries = [(256, width), (257, height), (258, bits), (259, 1), (262, 1), (273, 8), (277, 1), (278, height), (279, len(samples)), (339, kind)]
    return b"II*\0" + struct.pack("<I", 8 + len(samples)) + samples + struct.pack("<H", len(entries)) + b"".join(
        struct.pack("<HHII", tag, 4, 1, value) for tag, value in entries) + bytes(4)


def case_tiff_half_float__wider_samples(report):
    """Doubles are read as floats; whole numbers of 32 bits are refused by name."""
    images = sorted((report.folder / "images").iterdir())
    camera = json.loads((report.folder / "scene.json").read_text())["camera"]
    width, height = camera["width"], camera["height"]
    spot = [1 / (1 + ((x - width / 2) ** 2 + (y - height / 2) ** 2) / 25) for y in range(height) for x in range(width)]
    peaks = {}
    for bits, code in ((32, "f"), (64, "d")):
        for image in images:
            image.write_bytes(grey_tiff(width, height, bits, 3, struct.pack(f"<{len(spot)}{code}", *spot)))
        found = json.loads(report.glint("detect", ".", "--json", "-").stdout)
        peaks[bits] = [h["peak"] for frame in found["frames"] for h in frame["highlights"]]
    assert peaks[32] and peaks[64] == peaks[32], peaks
    for image in images:
        image.write_bytes(grey_tiff(width, height, 32, 1, bytes(4 * len(spot))))
    found = report.info()
    says(found, "1 samples of 32 bits", "is not supported")
    lacks(found, "damaged", "truncated")
