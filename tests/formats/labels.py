#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Labels for training and back: COCO against its published structure, masks and YOLO against the polygons with a rasteriser of its
own, and a corrected COCO file as the highlights of a scene.

    tests/formats/labels.py GLINT SESSION FOLDER"""
import json
import math
import pathlib
import shutil
import struct
import subprocess
import sys
import zlib

failures = []


def check(holds, what):
    if not holds:
        failures.append(what)
        print("FAILED: " + what)


def run(*arguments, code=0):
    done = subprocess.run([str(a) for a in arguments], capture_output=True, text=True, encoding="utf-8")
    check(done.returncode == code, "%s: exit code %d, not %d: %s" % (" ".join(map(str, arguments[1:])), done.returncode, code, done.stderr))
    return done


def grey_png(file):
    """Width, height and the rows of an 8-bit grey PNG without interlacing (PNG specification, section 9)."""
    data, at, packed, head = file.read_bytes(), 8, b"", None
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + size]
        head = struct.unpack(">IIBBBBB", body) if kind == b"IHDR" else head
        packed += body if kind == b"IDAT" else b""
        at += 12 + size
    width, height, bits, colour = head[:4]
    assert (bits, colour) == (8, 0), file
    raw, rows, above = zlib.decompress(packed), [], bytes(width)
    for y in range(height):
        filter_type, row = raw[y * (width + 1)], bytearray(raw[y * (width + 1) + 1:(y + 1) * (width + 1)])
        for x in range(width):
            left, up, corner = row[x - 1] if x else 0, above[x], above[x - 1] if x else 0
            estimate = left + up - corner
            paeth = min((abs(estimate - left), 0, left), (abs(estimate - up), 1, up), (abs(estimate - corner), 2, corner))[2]
            row[x] = (row[x] + (0, left, up, (left + up) // 2, paeth)[filter_type]) % 256
        rows.append(bytes(row))
        above = rows[-1]
    return width, height, rows


def inside(polygons, x, y):
    """Even-odd rule for each polygon; and the distance to the nearest side."""
    hit, nearest = False, math.inf
    for p in polygons:
        odd = False
        for (ax, ay), (bx, by) in zip(p, p[1:] + p[:1]):
            if (ay > y) != (by > y) and x < ax + (y - ay) * (bx - ax) / (by - ay):
                odd = not odd
            dx, dy = bx - ax, by - ay
            t = max(0, min(1, ((x - ax) * dx + (y - ay) * dy) / ((dx * dx + dy * dy) or 1)))
            nearest = min(nearest, math.hypot(x - ax - t * dx, y - ay - t * dy))
        hit = hit or odd
    return hit, nearest


def points(flat):
    return list(zip(flat[::2], flat[1::2]))


def check_coco(coco, name):
    """cocodataset.org, "Data format", object detection."""
    for key in ("info", "images", "annotations", "categories"):
        check(key in coco, "%s has no %s" % (name, key))
    images = {i["id"]: i for i in coco["images"]}
    categories = {c["id"]: c for c in coco["categories"]}
    check(len(images) == len(coco["images"]) and len(categories) == len(coco["categories"]), name + ": a repeated id")
    check(len({a["id"] for a in coco["annotations"]}) == len(coco["annotations"]), name + ": a repeated id of an annotation")
    for image in images.values():
        check(isinstance(image["file_name"], str) and image["width"] > 0 and image["height"] > 0, "%s: image %s" % (name, image["id"]))
    for a in coco["annotations"]:
        where = "%s: annotation %d" % (name, a["id"])
        check(a["image_id"] in images and a["category_id"] in categories and a["iscrowd"] == 0, where)
        for flat in a["segmentation"]:
            check(len(flat) >= 6 and len(flat) % 2 == 0, where + ": polygon")
        p = points(a["segmentation"][0])
        xs, ys = [q[0] for q in p], [q[1] for q in p]
        image = images[a["image_id"]]
        check(min(xs) >= 0 and min(ys) >= 0 and max(xs) <= image["width"] and max(ys) <= image["height"], where + ": leaves the image")
        box = [min(xs), min(ys), max(xs) - min(xs), max(ys) - min(ys)]
        check(max(abs(u - v) for u, v in zip(box, a["bbox"])) < 1e-9, where + ": bbox")
        twice = sum(ax * by - bx * ay for (ax, ay), (bx, by) in zip(p, p[1:] + p[:1]))
        check(abs(abs(twice) / 2 - a["area"]) < 1e-6 and a["area"] > 0, where + ": area")
        check(set(a["attributes"]) == {"coverage", "truncated", "occluded", "edge_share", "level"}, where + ": attributes")


def check_masks(out, coco, model):
    index = json.loads((out / "masks.json").read_text("utf-8"))
    lights = {c["id"]: c["name"].removeprefix("highlight ") for c in coco["categories"]}
    compared = 0
    for row in index["masks"]:
        if row["of"] != model:
            continue
        width, height, rows = grey_png(out / row["file"])
        shapes = [[(x - 0.5, y - 0.5) for x, y in points(a["segmentation"][0])] for a in coco["annotations"]
                  if a["image_id"] == row["frame"] and lights[a["category_id"]] == row["light"]]
        xs, ys = [x for s in shapes for x, _ in s], [y for s in shapes for _, y in s]
        check(sum(v == 255 for r in rows for v in r) == row["pixels"], row["file"] + ": number of pixels")
        if not shapes:
            check(row["pixels"] == 0, row["file"] + ": pixels without a polygon")
            continue
        area = range(max(0, int(min(ys)) - 2), min(height, int(max(ys)) + 3)), range(max(0, int(min(xs)) - 2), min(width, int(max(xs)) + 3))
        found = 0
        for y in area[0]:
            for x in area[1]:
                hit, near = inside(shapes, x, y)
                found += rows[y][x] == 255
                if near > 1e-6:
                    check(hit == (rows[y][x] == 255), "%s: pixel %d %d" % (row["file"], x, y))
        check(found == row["pixels"], row["file"] + ": pixels far from the polygon")
        compared += 1
    check(compared >= 12, "only %d masks were compared" % compared)


def check_yolo(folder, coco, frames):
    notes = json.loads((folder / "notes.json").read_text("utf-8"))
    classes = (folder / "classes.txt").read_text("utf-8").splitlines()
    check(classes == [c["name"] for c in coco["categories"]], "classes.txt")
    check(len(list((folder / "labels").iterdir())) == len(notes["files"]) == frames, "one label file for each image")
    for file in notes["files"]:
        lines = (folder / file["file"]).read_text("utf-8").splitlines()
        expected = [a for a in coco["annotations"] if a["image_id"] == file["frame"]]
        check(len(lines) == len(expected) == len(file["highlights"]), file["file"] + ": number of lines")
        if file["image"]:
            check(pathlib.Path(file["file"]).stem == pathlib.Path(file["image"]).stem, file["file"] + ": name")
        for line, a in zip(lines, expected):
            number, *flat = line.split()
            check(int(number) == a["category_id"] - 1, file["file"] + ": class")
            scaled = [float(v) * (file["height"] if k % 2 else file["width"]) for k, v in enumerate(flat)]
            check(len(scaled) == len(a["segmentation"][0]) and
                  max(abs(u - v) for u, v in zip(scaled, a["segmentation"][0])) < 1e-5, file["file"] + ": polygon")


def check_return(glint, session, coco, folder):
    """Polygons that were moved by hand come back where they were put, as highlights of the named light, with a peak inside."""
    corrected = json.loads(json.dumps(coco))
    for a in corrected["annotations"]:
        a["segmentation"] = [[v + (0.25 if k % 2 == 0 else -0.5) for k, v in enumerate(a["segmentation"][0])]]
        a.pop("bbox"), a.pop("area")
    last = corrected["images"][-1]
    # Labelling programs number anew and drop folders; and one frame's labels were dropped altogether.
    for number, image in enumerate(corrected["images"]):
        old, image["id"] = image["id"], 1000 + number
        image["file_name"] = pathlib.PurePosixPath(image["file_name"]).name
        for a in corrected["annotations"]:
            a["image_id"] = 1000 + number if a["image_id"] == old else a["image_id"]
    corrected["annotations"] = [a for a in corrected["annotations"] if a["image_id"] != last["id"]]
    corrected["images"].append({"id": 5, "file_name": "elsewhere/x.png", "width": 7, "height": 7})
    corrected["annotations"].append({"id": 9999, "image_id": 5, "category_id": 1, "segmentation": [[1, 1, 2, 1, 2, 2]]})
    (folder / "corrected.json").write_text(json.dumps(corrected), "utf-8")
    made = folder / "labelled.json"
    done = run(glint, "convert", session, "--labels", folder / "corrected.json", "-o", made, "--allow-outside", "--all-warnings")
    check("elsewhere/x.png" in done.stderr and "1 of %d images" % len(corrected["images"]) in done.stderr, "unmatched images are listed: " + done.stderr)
    check("1 image has no label" in done.stderr, "a frame without labels is named: " + done.stderr)
    scene = json.loads(made.read_text("utf-8"))
    # A peak is measured in the photograph, wherever the polygon was moved.
    peaks = [[h["peak"] for h in frame["highlights"]] for frame in json.loads(run(glint, "detect", session, "--json", "-").stdout)["frames"]]
    lights = {c["id"]: c["name"].removeprefix("highlight ") for c in coco["categories"]}
    count = 0
    for number, frame in enumerate(scene["frames"][:-1]):
        annotations = [a for a in corrected["annotations"] if a["image_id"] == 1000 + number]
        highlights = frame.get("highlights", [])
        check(len(highlights) == len(annotations), "frame %d: %d highlights of %d labels" % (number, len(highlights), len(annotations)))
        for h, a in zip(highlights, annotations):
            want = [(x - 0.5, y - 0.5) for x, y in points(a["segmentation"][0])]
            got = [tuple(p) for p in h["contour"]]
            apart = max(min(math.dist(p, q) for q in got) for p in want)
            check(len(got) == len(want) and apart < 1e-9, "frame %d: contour %.3g px away" % (number, apart))
            check(inside([want], *h["peak"])[0], "frame %d: peak outside of its contour" % number)
            check(min(math.dist(h["peak"], p) for p in peaks[number]) < 1e-9, "frame %d: the peak is not that of the photograph" % number)
            check(h["light"] == lights[a["category_id"]] and h["level"] == 0.5, "frame %d: light or level" % number)
            count += 1
    check(count >= 20, "only %d highlights came back" % count)
    # And they are evidence: models are fitted to them, and scored against them, instead of what is detected.
    scored = json.loads(run(glint, "evaluate", made, "--models", "limit-angle", "--exclude", str(len(scene["frames"]) - 1), "--json", "-", "--allow-outside").stdout)
    check(scored["scored_against"] == "given contours", "the labels are used instead of detection: " + scored["scored_against"])


STRIP = {"glint_scene": 1, "name": "strip", "units": "m",
         "camera": {"width": 320, "height": 240, "fx": 400, "fy": 400, "cx": 159.5, "cy": 119.5},
         "surfaces": {"body": {"analytic": {"type": "sheet", "curvature": 0.8, "length": 0.6, "width": 0.9}}},
         "lights": [{"id": "lamp", "position": [0.3, -0.2, 1.8]}],
         "path": {"orbit": {"centre": [0, 0, 0], "radius": 0.5, "height": 1.6, "from": 0, "to": 6, "count": 16}},
         "render": {"reflectance": "ggx", "roughness": 0.15, "diffuse": 0.05, "bits": 32, "samples": 1}}


def along_the_end(contour, pose):
    """The share of a contour's length within a pixel of the strip's border, from the formula of its arc."""
    camera, (curvature, half_length, half_width) = STRIP["camera"], (0.8, 0.3, 0.45)
    corners = [(-1 + k / 20, -1) for k in range(40)] + [(1, -1 + k / 20) for k in range(40)]
    corners += [(-s, -t) for s, t in corners]
    border = []
    for s, t in corners:
        x, z = math.sin(curvature * half_length * s) / curvature, -(1 - math.cos(curvature * half_length * s)) / curvature
        u, v, w = (row[0] * x + row[1] * half_width * t + row[2] * z + row[3] for row in pose[:3])
        border.append((camera["cx"] + camera["fx"] * u / w, camera["cy"] + camera["fy"] * v / w))
    whole = along = 0.0
    for a, b in zip(contour, contour[1:] + contour[:1]):
        whole += math.dist(a, b)
        along += math.dist(a, b) if inside([border], (a[0] + b[0]) / 2, (a[1] + b[1]) / 2)[1] < 1 else 0
    return along / whole


def check_edges(glint, folder):
    """Highlights at the end of a strip are marked, and no others: by the walks that fail there (canonical) as by what lies on both sides
    of the contour (limit-angle). What is expected comes from the exact contours of the scene and the formula of the strip."""
    (folder / "strip.json").write_text(json.dumps(STRIP), "utf-8")
    run(glint, "synth", folder / "strip.json", "-o", folder / "strip")
    run(glint, "reconstruct", folder / "strip", "--model", "canonical,limit-angle", "--train", "spread:8", "-o", folder / "strip" / "s.glint")
    run(glint, "predict", folder / "strip" / "s.glint", "--labels", "coco", "--out", folder / "strip-labels")
    scene = json.loads((folder / "strip" / "scene.json").read_text("utf-8"))
    shares = [along_the_end([tuple(p) for p in f["highlights"][0]["contour"]], f["camera_from_world"]) for f in scene["frames"]]
    check(3 <= sum(s > 0.05 for s in shares) <= 13, "some highlights are cut and some are not: %s" % shares)
    for model in ("canonical", "limit-angle"):
        coco = json.loads((folder / "strip-labels" / ("labels_%s.json" % model)).read_text("utf-8"))
        check(len(coco["annotations"]) == len(shares), model + ": one label a frame")
        for a in coco["annotations"]:
            share, told = shares[a["image_id"]], a["attributes"]
            if share == 0 or share > 0.05:  # in between a corner alone is cut
                check(told["occluded"] == (share > 0), "%s, frame %d: %s, of %.3f at the end" % (model, a["image_id"], told, share))
            if model == "limit-angle":
                check(abs(told["edge_share"] - share) < 0.05, "frame %d: edge share %.3f, not %.3f" % (a["image_id"], told["edge_share"], share))


def check_refusals(glint, session, coco, folder):
    def changed(change):
        other = json.loads(json.dumps(coco))
        change(other)
        return json.dumps(other)

    def first(key, value):
        return changed(lambda c: c["annotations"][0].update({key: value}))

    cases = {
        "no JSON": ("{", "not valid JSON"),
        "a scene": ('{"glint_scene": 1}', "is no COCO file"),
        "a bit mask": (first("segmentation", {"counts": "x", "size": [1, 2]}), "annotations[0].segmentation: is a bit mask"),
        "a box": (first("segmentation", []), "annotations[0].segmentation: has no polygon"),
        "two points": (first("segmentation", [[1, 1, 2, 2]]), "annotations[0].segmentation[0]: must be x y of at least 3 points"),
        "five numbers": (first("segmentation", [[1, 1, 2, 2, 3, 1, 4]]), "has 7 numbers"),
        "a line": (first("segmentation", [[1, 1, 2, 2, 3, 3]]), "annotations[0].segmentation[0]: encloses no area"),
        "outside": (first("segmentation", [[1, 1, 2, 2, 1e6, 1]]), "annotations[0].segmentation[0][4]: lies outside"),
        "NaN": (first("segmentation", [[1, 1, 2, math.nan, 3, 1]]), "annotations[0].segmentation[0][3]: must be a finite number"),
        "no such image": (first("image_id", 77777), "annotations[0].image_id: no image"),
        "no such category": (first("category_id", 77777), "annotations[0].category_id: no category"),
        "level": (first("attributes", {"level": 2}), "annotations[0].attributes.level: must be between"),
        "another size": (changed(lambda c: c["images"][0].update({"width": 5})), "images[0]: is 5 x"),
        "an image twice": (changed(lambda c: c["images"].append(dict(c["images"][0], id=4711))), "file_name: a second image of frame"),
        "an id twice": (changed(lambda c: c["images"][1].update({"id": c["images"][0]["id"]})), "images[1].id: duplicate id"),
        "other images": (changed(lambda c: [i.update({"file_name": "x%d" % i["id"]}) for i in c["images"]]), "none of the"),
    }
    for name, (text, reason) in cases.items():
        (folder / "bad.json").write_text(text, "utf-8")
        done = run(glint, "convert", session, "--labels", folder / "bad.json", "-o", folder / "never.json", code=2)
        check(reason in done.stderr and "bad.json" in done.stderr and done.stderr.count("\n") == 1, "%s: %s" % (name, done.stderr))
        check(not (folder / "never.json").exists(), name + ": something was written")
    done = run(glint, "convert", session, "--labels", folder / "bad.json", "-o", folder / "transforms.json", code=2)
    check("--labels" in done.stderr, "labels without a place: " + done.stderr)


def main():
    glint, session, folder = sys.argv[1], sys.argv[2], pathlib.Path(sys.argv[3])
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    out = folder / "labels"
    run(glint, "predict", session, "--labels", "coco,masks,yolo", "--out", out)
    models = sorted(p.name[len("labels_"):-len(".json")] for p in out.glob("labels_*.json"))
    check(len(models) == 4, "models: %s" % models)
    for model in models:
        check_coco(json.loads((out / ("labels_%s.json" % model)).read_text("utf-8")), model)
    coco = json.loads((out / "labels_limit-angle.json").read_text("utf-8"))
    check_masks(out, coco, "limit-angle")
    check_yolo(out / "yolo" / "limit-angle", coco, len(coco["images"]))
    check_return(glint, session, coco, folder)
    check_refusals(glint, session, coco, folder)
    check_edges(glint, folder)
    run(glint, "predict", session, "--labels", "yolo", "--frames", "0-1", "--out", folder / "two")
    check(sorted(p.name for p in (folder / "two").iterdir()) == ["yolo"], "what was asked for, and no more")
    check(len(list((folder / "two" / "yolo" / "dual" / "labels").iterdir())) == 2, "two frames, two files")
    for arguments, reason in ((["--labels", "png", "--out", folder / "new"], "'png' is not one of"), (["--labels", "coco"], "needs --out"),
                              (["--labels", "coco", "--out", out], "labels")):
        check(reason in run(glint, "predict", session, *arguments, code=2).stderr, reason)
    check(not (folder / "new").exists(), "a folder for labels that were refused")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
