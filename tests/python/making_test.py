# SPDX-License-Identifier: BSD-3-Clause
"""What is made beside an inspection (retexture, synth, trade-off, labels) is what the command line makes: files byte for byte, numbers to the last
bit. Truth: the program `glint`."""
import json
import pathlib
import subprocess
import sys

import numpy as np
import pytest

import glint

SOURCE = pathlib.Path(__file__).resolve().parents[2]
ELLIPSOID = SOURCE / "sessions/ellipsoid/ellipsoid.glint"
LESSON = SOURCE / "sessions/lessons/plane"


def run(program, *arguments, code=0):
    done = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, check=False)
    assert done.returncode == code, done.stderr
    return done


def tree(folder):
    """Every file below a folder with its bytes."""
    return {str(f.relative_to(folder)): f.read_bytes() for f in sorted(pathlib.Path(folder).rglob("*")) if f.is_file()}


@pytest.fixture(scope="module")
def session():
    return glint.open(ELLIPSOID)


@pytest.fixture(scope="module")
def inspection(session):
    return glint.inspect(session, ["limit-angle"])


@pytest.fixture(scope="module")
def wood(tmp_path_factory, session):
    """A texture: stripes, as a file that any program reads (PPM)."""
    file = tmp_path_factory.mktemp("texture") / "wood.ppm"
    codes = np.zeros((16, 16, 3), np.uint8)
    codes[:] = (160, 110, 60)
    codes[::2] = (90, 60, 30)
    file.write_bytes(b"P6 16 16 255\n" + codes.tobytes())
    # The inverse sRGB curve as IEC 61966-2-1 states it.
    c = codes / 255.0
    return file, np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)


@pytest.mark.parametrize("wish", ["remove", "texture"])
def test_retexture_writes_the_same_files(wish, session, wood, program, tmp_path):
    how = {"remove": (["--remove"], {"remove": True}),
           "texture": (["--texture", wood[0], "--mapping", "spherical", "--repeat", 2], {"texture": wood[0], "mapping": "spherical", "repeat": 2})}
    flags, keywords = how[wish]
    theirs = run(program, "retexture", ELLIPSOID, "--frame", "0012", "--set", "predict.directions=40", *flags, "-o", tmp_path / "theirs.png",
                 "--marks", tmp_path / "theirs_marks.png")
    ours = glint.retexture(session, "0012", predict_directions=40, **keywords)
    ours.save(str(tmp_path / "ours.png"))
    ours.save_marks(str(tmp_path / "ours_marks.png"))
    files = tree(tmp_path)
    assert files["ours.png"] == files["theirs.png"] and files["ours_marks.png"] == files["theirs_marks.png"]
    assert ours.model in theirs.stdout and ours.frame == "0012"
    light = ours.lights[0]
    assert f"{light['strength'][0]:.4f}" in theirs.stdout and f"{light['views']:d}" in theirs.stdout
    # The arrays are what the files show, and only marked pixels may differ from the photograph when a highlight is removed.
    assert ours.picture.shape == (*ours.marks.shape, 3) and not ours.picture.flags.writeable
    assert set(np.unique(ours.marks)) <= {0, 1, 2} and (ours.marks == 2).sum() > 100
    if wish == "remove":
        codes = np.rint(session.scene.photograph(12) * 255)
        changed = np.abs(np.rint(ours.picture * 255) - codes).max(axis=2) > 0
        assert changed.sum() > 100 and not changed[ours.marks == 0].any()


def test_retexture_of_an_inspection_and_of_arrays(session, inspection, wood):
    keywords = {"mapping": "box", "model": "limit-angle"}
    of_file = glint.retexture(session, 12, texture=wood[0], **keywords)
    of_inspection = glint.retexture(inspection, 12, texture=str(wood[0]), **keywords)
    assert np.array_equal(of_file.picture, of_inspection.picture) and np.array_equal(of_file.marks, of_inspection.marks)
    of_array = glint.retexture(inspection, 12, texture=wood[1], **keywords)
    assert np.abs(of_array.picture - of_file.picture).max() < 1e-4  # float32 on two ways through the curve
    # A background with nothing on it: what is not marked stays.
    plain = np.full((*of_file.marks.shape, 3), 0.2)
    over = glint.retexture(inspection, 12, background=plain, model="limit-angle")
    untouched = over.picture[over.marks == 0]
    assert np.abs(untouched - (1.055 * 0.2 ** (1 / 2.4) - 0.055)).max() <= 0.5 / 255 + 1e-6 and over.picture.max() > 0.6  # unmarked: less than half a code


def test_what_retexture_refuses(session, inspection, tmp_path):
    for wrong in ({}, {"remove": True, "texture": "a.png"}, {"remove": True, "repeat": 0}, {"remove": True, "model": "no-model"},
                  {"remove": True, "light": "no-light"}, {"texture": tmp_path / "missing.png"}):
        with pytest.raises(glint.InputError):
            glint.retexture(inspection, 12, **wrong)
    image = np.full((8, 8, 3), 0.5)
    for wrong in ({"background": image}, {"texture": image[..., 0]}, {"texture": -image}, {"texture": image * np.nan}, {"remove": True, "albedo": 0},
                  {"remove": True, "mapping": "crumpled"}):
        with pytest.raises(ValueError):
            glint.retexture(inspection, 12, **wrong)
    with pytest.raises(glint.Stopped):
        glint.retexture(session, 12, remove=True, progress=lambda *_: False)
    made = glint.retexture(inspection, 12, remove=True)
    photograph = SOURCE / "sessions/ellipsoid/frames/0012.png"
    before = photograph.read_bytes()
    with pytest.raises(glint.InputError):
        made.save(str(photograph))
    assert photograph.read_bytes() == before


def test_synth_makes_the_same_folder(program, tmp_path):
    spec = json.loads((LESSON / "spec.json").read_text())
    spec["camera"] = {"width": 160, "height": 120, "fx": 180, "fy": 180, "cx": 79.5, "cy": 59.5}
    file = tmp_path / "spec.json"
    file.write_text(json.dumps(spec))
    run(program, "synth", file, "-o", tmp_path / "theirs")
    stages = []
    scene = glint.synth(file, tmp_path / "ours", progress=lambda *event: stages.append(event))
    ours, theirs = tree(tmp_path / "ours"), tree(tmp_path / "theirs")
    assert ours == theirs and len(ours) >= 1
    assert len(scene) == len(json.loads(theirs["scene.json"])["frames"]) and stages
    assert pathlib.Path(scene.file) == tmp_path / "ours/scene.json"


def test_synth_without_a_highlight_and_what_it_refuses(program, tmp_path):
    spec = json.loads((LESSON / "spec.json").read_text())
    for light in spec["lights"]:
        light["position"] = [0, 0, -5.0]  # behind the plane
    file = tmp_path / "spec.json"
    file.write_text(json.dumps(spec))
    run(program, "synth", file, "-o", tmp_path / "theirs", code=3)
    with pytest.raises(glint.CannotAnswer) as nothing:
        glint.synth(file, tmp_path / "ours")
    assert nothing.value.reason == "no highlight" and tree(tmp_path / "ours") == tree(tmp_path / "theirs")
    file.write_text("{")
    with pytest.raises(glint.InputError):
        glint.synth(file, tmp_path / "nothing")
    assert not (tmp_path / "nothing").exists()


def test_labels_are_the_same_files(inspection, program, tmp_path):
    run(program, "predict", ELLIPSOID, "--labels", "coco,masks,yolo", "--frames", "3-9", "--out", tmp_path / "theirs")
    ours = glint.inspect(glint.open(ELLIPSOID))
    glint.write_labels(ours, tmp_path / "ours", "coco,masks,yolo", frames="3-9")
    assert tree(tmp_path / "ours") == tree(tmp_path / "theirs") and len(tree(tmp_path / "ours")) > 10
    before = tree(tmp_path)
    for wrong in ((tmp_path / "ours", "coco"), (tmp_path / "new", "paper"), (tmp_path / "new", "")):
        with pytest.raises(glint.InputError):
            glint.write_labels(inspection, *wrong)
    with pytest.raises(glint.InputError):
        glint.write_labels(inspection, tmp_path / "new", frames=[99])
    assert tree(tmp_path) == before and not (tmp_path / "new").exists()


def test_the_trade_off_measures_the_same_errors(program, tmp_path):
    models, flags = ["primal", "limit-angle"], ["--train", "0-3", "--repeats", 1, "--max-trials", 4]
    run(program, "tradeoff", LESSON / "scene.json", "--models", ",".join(models), *flags, "--json", tmp_path / "theirs.json")
    theirs = json.loads((tmp_path / "theirs.json").read_text())
    ours = glint.tradeoff(glint.open(LESSON / "scene.json"), models, train="0-3", repeats=1, max_trials=4)
    document = json.loads(ours.to_json())

    def by_setting(points):
        """Everything but times, and what follows from times."""
        varying = {"predict_us", "fit_us", "peak_mb", "pareto"}
        return {p["settings"]["model"] + json.dumps(p["set"], sort_keys=True): {k: v for k, v in p.items() if k not in varying} for p in points}

    mine, other = by_setting(document["points"]), by_setting(theirs["points"])
    both = mine.keys() & other.keys()  # which settings are measured in full depends on times; each model's own is always among them
    assert len(both) >= len(models) and all(mine[k] == other[k] for k in both)
    assert document.keys() == theirs.keys()
    # The attributes are the document's numbers, and the front is what its definition says.
    assert len(ours) == len(document["points"]) == len(ours.points)
    costs = [(p.ranked_error_pct, p.predict_us) for p in ours.points]
    for point, stated, cost in zip(ours.points, document["points"], costs):
        assert point.contour_error_pct == stated["contour_error_pct"] and point.predict_us == stated["predict_us"]
        assert point.pareto == (not any(c[0] <= cost[0] and c[1] <= cost[1] and c != cost for c in costs))
    assert ours.points[ours.chosen].pareto and ours.chosen == ours.presets["balanced"] and ours.reason


def test_a_trade_off_that_nothing_meets(tmp_path):
    scene = glint.open(LESSON / "scene.json")
    with pytest.raises(glint.CannotAnswer) as nothing:
        glint.tradeoff(scene, "limit-angle", train="0-3", repeats=1, max_trials=1, max_error_pct=1e-12)
    assert nothing.value.reason == "not reached" and nothing.value.tradeoff.chosen is None and len(nothing.value.tradeoff) >= 1
    assert "an error of at most" in nothing.value.detail
    with pytest.raises(glint.CannotAnswer, match="within"):
        glint.tradeoff(scene, "limit-angle", train="0-3", repeats=1, max_trials=1, budget_us=1e-9)
    for wrong in ({"budget_us": -1}, {"budget_us": 1, "max_error_pct": 1}, {"repeats": 0}, {"max_trials": 0}, {"models": ["no-model"]}):
        with pytest.raises(glint.InputError):
            glint.tradeoff(scene, **wrong)
    with pytest.raises(glint.Stopped):
        glint.tradeoff(scene, "limit-angle", train="0-3", progress=lambda *_: False)


def test_a_plugin_adds_its_model(program, tmp_path):
    example = next(iter(pathlib.Path(program).parents[1].rglob("example.so")), None)
    if example is None:
        pytest.skip("the example plugin was not built")
    scene = SOURCE / "sessions/lessons/plane/scene.json"
    theirs = json.loads(run(program, "evaluate", scene, "--models", "flat-mirror", "--train", "0-3", "--json", "-", "--plugin", example).stdout)
    # In a process of its own: a plugin that was loaded stays.
    lines = ["import glint, sys", "try: glint.model('flat-mirror')", "except glint.InputError as error: assert '--plugin' in str(error)",
             "else: sys.exit('known before')", "glint.load_plugin(sys.argv[1])", "assert 'model flat-mirror' in glint.plugins()[0]",
             "print(glint.report(glint.inspect(glint.open(sys.argv[2]), ['flat-mirror'], train='0-3')))"]
    done = subprocess.run([sys.executable, "-c", "\n".join(lines), example, scene], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    ours = json.loads(done.stdout)["models"]["flat-mirror"]["summary"]
    assert {k: v for k, v in ours.items() if k != "time_us"} == {k: v for k, v in theirs["models"]["flat-mirror"]["summary"].items() if k != "time_us"}
    assert ours["predicted"] > 0
    with pytest.raises(glint.InputError):
        glint.load_plugin(str(tmp_path / "missing.so"))
    assert glint.plugins() == []
