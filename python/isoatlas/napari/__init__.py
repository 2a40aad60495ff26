# SPDX-License-Identifier: Apache-2.0
"""isoatlas in napari: meshes ``Image`` and ``Labels`` layers into ``Surface`` layers.

napari finds the widget through its manifest, napari.yaml; `import isoatlas` does not import this
package. `mesh_layer` and `surface_data` work in scripts as well, without a window:

    >>> from isoatlas.napari import mesh_layer, surface_data
    >>> mesh = mesh_layer(viewer.layers["nuclei"], 300.5)
    >>> data, options, kind = surface_data(viewer.layers["nuclei"], mesh)
    >>> viewer.add_surface(data, **options)

See docs/hosts/napari.md.
"""

from __future__ import annotations

from ._layers import mesh_layer, surface_data

__all__ = ["mesh_layer", "surface_data"]
