# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials of a tree as UsdPreviewSurface. No ``bpy``.

Source: Pixar, UsdPreviewSurface Specification 2.6.
"""

import numpy as np

from ..gltf.document import SUFFIXES


class Materials:
    """Writes each material of a tree once. uv_names: primvars in the order of TEXCOORD_0 and so on; folder: name of the
    textures' folder beside the file; files: {name: bytes} of the textures."""

    def __init__(self, pxr, stage, scope, folder, uv_names):
        self._pxr, self._stage, self._scope, self._folder = pxr, stage, scope, folder
        self._uv_names, self._paths, self.files = uv_names, {}, {}

    def path_of(self, material):
        """The path of a tree_data.Material on the stage."""
        if id(material) not in self._paths:
            self._paths[id(material)] = self._add(material)
        return self._paths[id(material)]

    def bind(self, mesh, paths, numbers):
        """Binds materials to a mesh: paths by number, numbers (T,) of its triangles."""
        used = np.unique(numbers)
        api = self._pxr.UsdShade.MaterialBindingAPI
        if len(used) == 1:
            self._bind(mesh.GetPrim(), paths[used[0]])
            return
        binding = api.Apply(mesh.GetPrim())
        for number in used.tolist():
            faces = self._pxr.Vt.IntArray.FromNumpy(np.flatnonzero(numbers == number).astype(np.int32))
            name = paths[number].rpartition("/")[2]
            self._bind(binding.CreateMaterialBindSubset(name, faces).GetPrim(), paths[number])
        binding.SetMaterialBindSubsetsFamilyType(self._pxr.UsdGeom.Tokens.partition)

    def _bind(self, prim, path):
        shade = self._pxr.UsdShade
        shade.MaterialBindingAPI.Apply(prim).Bind(shade.Material.Get(self._stage, path))

    def _shader(self, path, kind, **inputs):
        """A shader node. inputs: (type, value), or an output to connect to."""
        shader = self._pxr.UsdShade.Shader.Define(self._stage, path)
        shader.CreateIdAttr(kind)
        for name, given in inputs.items():
            if isinstance(given, tuple):
                shader.CreateInput(name, given[0]).Set(given[1])
            else:
                shader.CreateInput(name, given.GetTypeName()).ConnectToSource(given)
        return shader

    def _texture(self, path, texture, color_space, **inputs):
        """The shader node of a tree_data.Texture."""
        kinds, tf = self._pxr.Sdf.ValueTypeNames, self._pxr.Tf
        file = f"{len(self.files)}_{tf.MakeValidIdentifier(texture.name)}{SUFFIXES[texture.mime_type]}"
        known = next((name for name, data in self.files.items() if data == texture.data), file)
        self.files[known] = texture.data
        reader = self._shader(
            f"{path}_uv", "UsdPrimvarReader_float2", varname=(kinds.String, self._uv_names[texture.texcoord])
        )
        place = reader.CreateOutput("result", kinds.Float2)
        if texture.scale != (1.0, 1.0) or texture.offset != (0.0, 0.0):
            moved = self._shader(
                f"{path}_place",
                "UsdTransform2d",
                scale=(kinds.Float2, texture.scale),
                translation=(kinds.Float2, texture.offset),
                **{"in": place},
            )
            place = moved.CreateOutput("result", kinds.Float2)
        return self._shader(
            path,
            "UsdUVTexture",
            file=(kinds.Asset, f"./{self._folder}/{known}"),
            sourceColorSpace=(kinds.Token, color_space),
            wrapS=(kinds.Token, "repeat"),
            wrapT=(kinds.Token, "repeat"),
            st=place,
            **inputs,
        )

    def _add(self, material):
        kinds, gf = self._pxr.Sdf.ValueTypeNames, self._pxr.Gf
        name, number = self._pxr.Tf.MakeValidIdentifier(material.name), 1
        path = f"{self._scope}/{name}"
        while self._stage.GetPrimAtPath(path):
            number, path = number + 1, f"{self._scope}/{name}_{number + 1}"
        self._pxr.UsdGeom.Scope.Define(self._stage, self._scope)
        made = self._pxr.UsdShade.Material.Define(self._stage, path)
        surface = self._shader(
            f"{path}/Surface",
            "UsdPreviewSurface",
            roughness=(kinds.Float, float(material.roughness)),
            metallic=(kinds.Float, 0.0),
        )
        color = surface.CreateInput("diffuseColor", kinds.Color3f)
        if material.base is None:
            color.Set(gf.Vec3f(*map(float, material.color)))
        else:
            base = self._texture(f"{path}/Color", material.base, "sRGB")
            color.ConnectToSource(base.CreateOutput("rgb", kinds.Float3))
            if material.cutoff is not None:
                alpha = base.CreateOutput("a", kinds.Float)
                surface.CreateInput("opacity", kinds.Float).ConnectToSource(alpha)
                surface.CreateInput("opacityThreshold", kinds.Float).Set(float(material.cutoff))
        if material.normal is not None:
            normal = self._texture(
                f"{path}/Normal",
                material.normal,
                "raw",
                scale=(kinds.Float4, gf.Vec4f(2, 2, 2, 2)),
                bias=(kinds.Float4, gf.Vec4f(-1, -1, -1, -1)),
            )
            target = surface.CreateInput("normal", kinds.Normal3f)
            target.ConnectToSource(normal.CreateOutput("rgb", kinds.Float3))
        made.CreateSurfaceOutput().ConnectToSource(surface.CreateOutput("surface", kinds.Token))
        return path
