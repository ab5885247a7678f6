"""Run by Blender: import a file as anyone does, by the defaults, and write where its joints are in some frames.

blender -b --python blender_reads.py -- FILE OUT.json FRAME...
"""

from __future__ import annotations

import builtins
import json
import sys

import bpy
import numpy

numpy.bool = bool  # Blender 3.4 with numpy 1.24: a name that numpy dropped
_open = builtins.open
builtins.open = lambda file, mode="r", *args, **named: _open(file, mode.replace("U", ""), *args, **named)
# Blender 3.4 with Python 3.11: a mode that Python dropped

file, out, *frames = sys.argv[sys.argv.index("--") + 1 :]
bpy.ops.wm.read_factory_settings(use_empty=True)
if file.endswith(".glb"):
    bpy.ops.import_scene.gltf(filepath=file)
else:
    bpy.ops.import_anim.bvh(filepath=file)
(armature,) = (thing for thing in bpy.context.scene.objects if thing.type == "ARMATURE")
seen = []
for frame in map(float, frames):
    bpy.context.scene.frame_set(int(frame), subframe=frame - int(frame))
    posed = armature.evaluated_get(bpy.context.evaluated_depsgraph_get())
    seen.append({bone.name: list(posed.matrix_world @ bone.head) for bone in posed.pose.bones})
with _open(out, "w") as target:
    json.dump(seen, target)
