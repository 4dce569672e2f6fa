# SPDX-License-Identifier: BSD-3-Clause
"""A shared page in a browser: no error, no load, frames by a real mouse, contours where the data say, and the same without WebGL but for the scene.

browser_test.py GLINT SESSIONS     77 where there is no Chromium
"""
import pathlib
import sys
import tempfile

import browser
from structure_test import Page, check_hostile, project, run

WIDTH, HEIGHT = 1200, 900


def box(page, element):
    """Left, top, width and height in the window, after the element was brought into it."""
    return page.evaluate(f"(() => {{ const e = document.getElementById('{element}'); e.scrollIntoView({{block: 'center'}}); "
                         "const b = e.getBoundingClientRect(); return [b.left, b.top, b.width, b.height]; })()")


def middle(page, element):
    left, top, width, height = box(page, element)
    return left + width / 2, top + height / 2


def show(page, *layers):
    """These layers alone."""
    page.evaluate(f"for (const b of document.querySelectorAll('[data-layer]')) if (b.checked !== {list(layers)!r}.includes(b.dataset.layer)) b.click()")
    page.settle()


def quiet(page, what):
    assert not page.log, (what, page.log)
    loads = [url for url in page.loads if not url.startswith(("file:", "data:", "about:"))]
    assert not loads, (what, loads)


def near(colour, wanted, tolerance):
    return all(abs(a - b) <= tolerance for a, b in zip(colour, wanted))


def share_of(picture, points, wanted, tolerance=60, reach=2):
    """How many of the points have a pixel of that colour within reach."""
    hits = 0
    for x, y in points:
        column, row = round(x - 0.5), round(y - 0.5)
        hits += any(near(picture.at(c, r), wanted, tolerance) for c in range(column - reach, column + reach + 1) for r in range(row - reach, row + reach + 1)
                    if 0 <= c < picture.width and 0 <= r < picture.height)
    return hits / len(points)


def rgb(text):
    return tuple(int(text[i:i + 2], 16) for i in (1, 3, 5))


def check_frames(page, data):
    """The slider by a click, by dragging; the buttons; a row of the table."""
    left, top, width, height = box(page, "slider")
    place = lambda share: (left + width * share, top + height / 2)
    page.click(*place(0.97))
    page.wait(f"glintPage.state.frame === {len(data['frames']) - 1}", 5)
    page.mouse("mousePressed", *place(0.98))
    for share in (0.8, 0.6, 0.5):
        page.mouse("mouseMoved", *place(share))
    page.mouse("mouseReleased", *place(0.5), buttons=0)
    reached = page.evaluate("glintPage.state.frame")
    assert 0 < reached < len(data["frames"]) - 1, reached
    page.click(*middle(page, "next"))
    page.wait(f"glintPage.state.frame === {reached + 1}", 5)
    assert f"Frame {data['frames'][reached + 1]['id']}" in page.evaluate("document.getElementById('frame-name').textContent")
    page.evaluate("document.querySelector('#errors tbody tr[data-place=\"1\"]').click()")
    assert page.evaluate("glintPage.state.frame") == 1
    shown = page.evaluate("[...document.querySelectorAll('#models td[data-value]')].map((c) => c.dataset.value)")
    wanted = [str(page.evaluate(f"String({v!r})")) for m in data["models"] for v in
              [data["evaluation"]["models"][m["id"]]["summary"]["contour_error_pct"][k] for k in ("mean", "median", "p95", "max")]]
    assert shown == wanted, (shown, wanted)


def check_photograph(page, data, model):
    """The predicted contour's pixels lie where the data say, in its colour."""
    frame = next(i for i, f in enumerate(data["frames"]) if any(l["model"] == model for l in f["lines"]))
    page.evaluate(f"glintPage.select({frame})")
    show(page, "predicted-contours")
    page.evaluate(f"for (const b of document.querySelectorAll('#models tbody input')) if (b.checked !== (b.parentNode.textContent.trim() === '{model}')) b.click()")
    x, y, width, height = box(page, "photo")
    page.settle()
    camera = data["frames"][frame]["camera"]
    scale = min(width / camera["width"], height / camera["height"])
    to_page = lambda u, v: (x + width / 2 + (u + 0.5 - camera["width"] / 2) * scale, y + height / 2 + (v + 0.5 - camera["height"] / 2) * scale)
    line = next(l for l in data["frames"][frame]["lines"] if l["model"] == model)
    points = [to_page(u, v) for u, v in zip(line["points"][0::2], line["points"][1::2])]
    picture = page.picture()
    colour = rgb(next(m["colour"] for m in data["models"] if m["id"] == model))
    found = share_of(picture, points, colour, reach=1)
    wrong = share_of(picture, [(u + 40, v + 40) for u, v in points], colour, reach=1)
    least = 0.45 if line["dash"] else 0.9  # of dashes every third pixel or so is a gap
    assert found > least and wrong < 0.1, (found, wrong)


def check_through(page, data, model):
    """Looked through a camera, the contour on the surface covers the pixels that K [R | t] gives it."""
    frame = page.evaluate("glintPage.state.frame")
    page.evaluate("document.getElementById('through').click()")
    show(page, "predicted-contours", "surface")
    x, y, width, height = box(page, "canvas")
    camera = data["frames"][frame]["camera"]
    scale = min(width / camera["width"], height / camera["height"])
    to_page = lambda u, v: (x + width / 2 + (u + 0.5 - camera["width"] / 2) * scale, y + height / 2 + (v + 0.5 - camera["height"] / 2) * scale)
    chain = next(t["chains"][0] for t in data["frames"][frame]["things"] if t["role"] == "predicted-contour" and t["model"] == model)
    points = [to_page(*project(camera, chain[i:i + 3])) for i in range(0, len(chain), 3)]
    for point, i in list(zip(points, range(0, len(chain), 3)))[:5]:
        said = page.evaluate(f"glintPage.place({chain[i:i + 3]})")
        assert abs(said[0] - point[0]) < 0.1 and abs(said[1] - point[1]) < 0.1, (said, point)
    colour = rgb(next(m["colour"] for m in data["models"] if m["id"] == model))
    picture = page.picture()
    found = share_of(picture, points, colour, reach=1)
    wrong = share_of(picture, [(u + 40, v + 40) for u, v in points], colour, reach=1)
    assert found > 0.9 and wrong < 0.1, (found, wrong)
    page.evaluate("document.getElementById('through').click()")


def check_equation(page, data):
    """The step's equation is drawn in the colour of its text, in both themes; who copies or listens gets the plain form; it never widens the page."""
    step = data["lesson"]["steps"][page.evaluate("glintPage.state.step")]
    typeset = "document.querySelector('#step-equation .typeset')"
    assert page.evaluate(f"{typeset}.getAttribute('role') + ': ' + {typeset}.getAttribute('aria-label')") == "img: " + step["equation"]
    copied = page.evaluate("(getSelection().selectAllChildren(document.getElementById('step-equation')), getSelection().toString())")
    page.evaluate("getSelection().removeAllRanges()")
    assert copied == step["equation"], copied
    seen = set()
    for _ in range(2):
        page.evaluate("document.getElementById('theme').click()")
        ink = page.evaluate("getComputedStyle(document.getElementById('step-text')).color.match(/\\d+/g).map(Number)")
        x, y, width, height = (round(v) for v in box(page, "step-equation"))
        picture = page.picture()
        pixels = [picture.at(c, r) for r in range(y, y + height) for c in range(x, x + width)]
        assert sum(near(pixel, ink, 30) for pixel in pixels) > 40, "no ink"
        seen.add(tuple(ink))
    assert len(seen) == 2, seen
    size = lambda: page.evaluate(f"{typeset}.querySelector('svg').getBoundingClientRect().height")
    before = size()
    page.evaluate("document.getElementById('step-equation').style.fontSize = '200%'")
    assert abs(size() - 2 * before) < 1, "it does not scale with the text"
    page.evaluate("document.getElementById('lesson').style.width = '320px'")
    right = lambda e: page.evaluate(f"{e}.getBoundingClientRect().right")
    assert right(typeset) <= right("document.getElementById('lesson')"), "wider than its column"
    page.evaluate("document.getElementById('lesson').style.width = document.getElementById('step-equation').style.fontSize = ''")


def check_scene(page):
    """The scene is drawn, turns with the mouse, and comes back."""
    show(page, "surface", "cameras")
    page.evaluate("document.getElementById('reset').click()")
    page.settle()
    x, y, width, height = (round(v) for v in box(page, "canvas"))
    x, width = x + 2, width - 4  # without the border
    view = lambda: [b"".join(map(bytes, (page_row.at(c, r) for c in range(x, x + width, 2)))) for page_row in [page.picture()] for r in range(y + 2, y + height - 2, 4)]
    before = view()
    ground, pixels = before[0][:3], [row[i:i + 3] for row in before for i in range(0, len(row), 3)]
    assert sum(pixel != ground for pixel in pixels) > 0.03 * len(pixels), "nothing is drawn"
    page.mouse("mousePressed", x + width / 2, y + height / 2)
    page.mouse("mouseMoved", x + width / 2 + 90, y + height / 2 + 20)
    page.mouse("mouseReleased", x + width / 2 + 90, y + height / 2 + 20, buttons=0)
    page.settle()
    assert view() != before, "the scene does not turn"
    page.evaluate("document.getElementById('reset').click()")
    page.settle()
    assert view() == before, "the first view does not come back"


def check_moving(page, data):
    """The object is drawn where the chosen frame has it, the rays of all training frames are there, and the page says in which coordinates."""
    said = page.evaluate("document.getElementById('coordinates').textContent")
    assert "camera\u2019s coordinates" in said and "The lamp moves with the camera" in said, said
    check_photograph(page, data, "limit-angle")
    for frame in (1, 7, 4):
        page.evaluate(f"glintPage.select({frame})")
        check_through(page, data, "limit-angle")
    show(page, "rays")
    page.evaluate("document.getElementById('reset').click()")
    page.settle()
    picture, rays = page.picture(), 0
    for frame in data["frames"]:
        if frame["role"] == "training":
            (ray,) = [t["chains"][0] for t in frame["things"] if t["role"] == "reflected-ray"]
            places = [page.evaluate(f"glintPage.place({[a + s / 20 * (b - a) for a, b in zip(ray[:3], ray[3:])]})") for s in range(2, 10)]
            ground = picture.at(round(places[0][0]) + 60, round(places[0][1]) - 60)
            rays += sum(any(not near(picture.at(round(x) + i, round(y) + j), ground, 20) for i in (-1, 0, 1) for j in (-1, 0, 1)) for x, y in places) > 6
    assert rays == sum(frame["role"] == "training" for frame in data["frames"]), rays


def main():
    browser.chromium()
    glint, sessions = sys.argv[1], pathlib.Path(sys.argv[2])
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        lesson = sessions / "lessons/sphere/sphere.glint"
        run(glint, "share", sessions / "lessons/plane-to-cylinder/plane-to-cylinder.glint", "-o", folder / "page.html")
        data = Page((folder / "page.html").read_text(encoding="utf-8")).data()
        hostile = check_hostile(glint, lesson, folder)
        run(glint, "share", sessions / "lessons/moving-lamp/moving-lamp.glint", "-o", folder / "moving.html")
        with browser.Browser(WIDTH, HEIGHT) as page:
            page.open(f"file://{folder}/page.html#theme=dark")
            check_frames(page, data)
            page.evaluate("document.getElementById('step-next').click()")
            assert page.evaluate("document.getElementById('step-count').textContent") == f"Step 2 of {len(data['lesson']['steps'])}"
            check_equation(page, data)
            check_scene(page)
            check_photograph(page, data, "limit-angle")
            check_through(page, data, "limit-angle")
            page.click(*middle(page, "theme"))
            quiet(page, "page")
            page.open(f"file://{folder}/moving.html#theme=light")
            check_moving(page, Page((folder / "moving.html").read_text(encoding="utf-8")).data())
            quiet(page, "moving page")
            page.open(f"file://{hostile}#theme=light")
            assert page.evaluate("document.querySelectorAll('img, iframe').length") == 0
            assert "</script><script>" in page.evaluate("document.getElementById('title').textContent")
            assert page.evaluate("document.title").startswith("Glint: </script>")
            quiet(page, "hostile page")
        with browser.Browser(WIDTH, HEIGHT, ["--disable-3d-apis"]) as page:
            page.open(f"file://{folder}/page.html")
            assert "WebGL" in page.evaluate("document.getElementById('no-webgl').innerText")
            check_frames(page, data)
            assert page.evaluate("document.querySelectorAll('#photo image, #photo polygon').length") > 1
            loads = [url for url in page.loads if not url.startswith(("file:", "data:", "about:"))]
            assert not loads and not [l for l in page.log if l.startswith("exception")], (loads, page.log)


if __name__ == "__main__":
    main()
