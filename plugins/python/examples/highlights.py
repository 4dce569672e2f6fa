#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
# %% [markdown]
# # From highlights to predictions
#
# A session that comes with Glint: photographs of an ellipsoid, made by `glint synth`, so the lamp's true place is known. Six of the 24 frames
# train; the others are predicted.

# %%
import pathlib
import sys

import matplotlib.pyplot as plt
import numpy as np

import glint


def project_folder():
    """The folder that holds `sessions`: given as argument, else one of those above this file or the working folder."""
    given = [pathlib.Path(a) for a in sys.argv[1:2] if pathlib.Path(a).is_dir()]
    here = pathlib.Path(globals().get("__file__", ".")).resolve()
    return next(f for f in [*given, here, *here.parents] if (f / "sessions/ellipsoid/ellipsoid.glint").exists())


session = glint.open(project_folder() / "sessions/ellipsoid/ellipsoid.glint")
scene = session.scene
print(scene, "with surfaces", scene.surfaces)
print(scene.frames[0].camera)

# %% [markdown]
# ## Inspect
# One call does what `glint evaluate` does. Everything that was computed stays there: evidence, views, lights, fits, predictions, errors.

# %%
inspection = glint.inspect(session)
print(inspection.table())

# %% [markdown]
# ## The lamp
# Measured from the highlights alone, as `glint lights` does; the scene's true lamp is only looked at to see how far off that is.

# %%
lamp, = glint.lights(session).lamps
true = scene.lights[0]["position"]
print("measured  ", np.round(lamp.position, 5), "m")
print("true      ", true, "m")
print(f"off by    {1e3 * np.linalg.norm(lamp.position - true):.3f} mm, sigma {np.round(1e3 * np.sqrt(np.diag(lamp.covariance)), 3)} mm")

# %% [markdown]
# ## A held-out frame
# The photograph with the contour that was observed (white) and those that the session's models predict. Contours are NumPy arrays: views of Glint's memory.

# %%
frame = inspection.held_out[len(inspection.held_out) // 2]
observed = inspection.evidence[frame].highlights[0].contour
fig, (whole, close) = plt.subplots(1, 2, figsize=(11, 4.2))
for axes in (whole, close):
    axes.imshow(scene.photograph(frame))
    axes.fill(*observed.T, fill=False, edgecolor="white", linewidth=3, label="observed")
    for name, result in inspection.models.items():
        for comparison in (c for c in result.frames if c.frame == frame):
            for highlight in comparison.prediction.highlights:
                axes.fill(*highlight.contour.T, fill=False, edgecolor=glint.model(name).colour, linewidth=1.2, label=name)
    axes.set_axis_off()
margin = 12
close.set_xlim(observed[:, 0].min() - margin, observed[:, 0].max() + margin)
close.set_ylim(observed[:, 1].max() + margin, observed[:, 1].min() - margin)
close.legend(loc="upper right", fontsize=8)
whole.text(12, 40, f"frame {scene.frames[frame].id}", color="white")
fig.tight_layout()
if "--pictures" in sys.argv:
    fig.savefig(pathlib.Path(sys.argv[sys.argv.index("--pictures") + 1]) / "python-frame.png", dpi=110)

# %% [markdown]
# ## Errors over frames

# %%
fig, axes = plt.subplots(figsize=(8, 3.4))
for name, result in inspection.models.items():
    points = [(c.frame, row.metrics.contour_error_pct) for c in result.frames if c.frame in inspection.held_out for row in c.rows
              if row.metrics]
    axes.semilogy(*np.transpose(points), ".-", color=glint.model(name).colour, label=name)
axes.set_xlabel("frame")
axes.set_ylabel("contour error, %")
axes.legend(fontsize=8)
fig.tight_layout()
if "--pictures" in sys.argv:
    fig.savefig(pathlib.Path(sys.argv[sys.argv.index("--pictures") + 1]) / "python-errors.png", dpi=110)

# %% [markdown]
# ## Without files
# A camera, a mesh and a contour from NumPy are enough. Here the training views are those of the session, but the surface is a mesh of your own, and
# the camera is nobody's: a quarter of the way from one frame's place to another's.

# %%
triangles = scene.surface(0).tessellate(200)
body = glint.mesh(triangles.vertices, triangles.triangles, triangles.normals, surface_normals="curved")
views = [glint.TrainingView(v.camera, body, v.highlight, v.frame) for v in inspection.views]
fit = glint.fit("limit-angle", views)
a, b = (scene.frames[f].camera for f in inspection.held_out[:2])
centre = 0.75 * a.centre + 0.25 * b.centre
pose = a.camera_from_world.copy()
pose[:3, 3] = -pose[:3, :3] @ centre
prediction = glint.predict(fit, a.at(pose), body)
print(fit, f"limit angle {np.degrees(fit.limit_angle):.4f} deg")
print(prediction[0])

# %% [markdown]
# ## Settings, failures
# Settings are keyword arguments with the names of `glint evaluate --set`. What is wrong says so in the command line's words.

# %%
quick = glint.inspect(session, ["canonical"], predict_directions=12, train="spread:4")
print(f"12 directions, 4 frames: {quick.summary('canonical')['contour_error_pct']['mean']:.3f} %")
try:
    glint.inspect(session, predict_directions=1)
except glint.InputError as error:
    print("InputError:", error)
try:
    glint.fit("canonical", views[:1])
except glint.CannotAnswer as error:
    print("CannotAnswer:", error.reason)

# %% [markdown]
# ## Progress, and stopping
# A progress function is told how far the work is; one that returns False stops it. Ctrl-C stops it, too.

# %%
events = []
try:
    glint.inspect(session, progress=lambda stage, done, total: events.append((stage, done, total)) or len(events) < 5)
except glint.Stopped:
    print("stopped after", events[-1])
