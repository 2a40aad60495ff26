# SPDX-License-Identifier: Apache-2.0
"""The dock widget: a layer, an isovalue or a label, bounds, and a slider for the level."""

from __future__ import annotations

from typing import Any

from magicgui.widgets import (
    CheckBox,
    ComboBox,
    Container,
    FloatSlider,
    FloatSpinBox,
    LineEdit,
    ProgressBar,
    PushButton,
    Slider,
    SpinBox,
)
from napari.layers import Image, Labels
from napari.qt.threading import FunctionWorker, create_worker
from napari.utils.notifications import show_error
from qtpy.QtCore import QTimer

from .._mesh import Mesh
from ._layers import is_labels, mesh_layer, surface_data

_POLL_INTERVAL = 100  # milliseconds between two updates of the progress bar


class _Stopped(Exception):
    """The user pressed Stop."""


class MeshWidget(Container):
    """Meshes a layer into a Surface layer; a slider chooses the level of detail that it shows.

    Work runs in a thread; the window stays responsive.
    """

    def __init__(self, napari_viewer: Any) -> None:
        self._viewer = napari_viewer
        self._mesh: Mesh | None = None
        self._source: Any = None
        self._surface: Any = None
        self._worker: FunctionWorker[Mesh] | None = None
        self._fraction = 0.0
        self._layer = ComboBox(
            label="Layer", choices=self._layers, nullable=True, tooltip="An image or labels, 3-D"
        )
        self._isovalue = FloatSlider(
            label="Isovalue", min=0, max=1, tooltip="The surface where the image has this value"
        )
        self._label_number = SpinBox(
            label="Label", value=1, min=1, max=2**31 - 1, tooltip="The label to mesh"
        )
        self._smooth = FloatSpinBox(
            label="Smooth (voxels)", value=1.0, min=0, max=20, step=0.5,
            tooltip="Gaussian that removes the staircase of the voxels; 0: none",
        )
        self._distance = FloatSpinBox(
            label="Distance (voxels)", value=0.5, min=0.01, max=100, step=0.1,
            tooltip="Upper bound of the two-sided distance of the finest level",
        )
        self._count = SpinBox(
            label="Levels", value=4, min=1, max=16,
            tooltip="Levels of detail, each with about half the distance of the previous one",
        )
        self._keep = SpinBox(
            label="Components", value=0, min=0, max=10**6,
            tooltip="Keep only this number of largest components; 0: all",
        )
        self._closed = CheckBox(
            text="Close with caps", value=False,
            tooltip="Planar caps close the mesh where it leaves the image",
        )
        self._by_distance = CheckBox(text="Color by distance", value=False)
        self._run = PushButton(text="Mesh")
        self._bar = ProgressBar(value=0, min=0, max=100, visible=False)
        self._level = Slider(label="Level", value=0, min=0, max=0, enabled=False)
        self._triangles = LineEdit(label="Triangles")
        self._topology = LineEdit(label="Topology")
        self._within = LineEdit(label="Within", tooltip="Distance between mesh and surface")
        super().__init__(
            widgets=[
                self._layer, self._isovalue, self._label_number, self._smooth, self._distance,
                self._count, self._keep, self._closed, self._by_distance, self._run, self._bar,
                self._level, self._triangles, self._topology, self._within,
            ]
        )
        for fact in (self._triangles, self._topology, self._within):
            fact.native.setReadOnly(True)
        self._timer = QTimer(self.native)
        self._timer.timeout.connect(self._show_progress)
        self._layer.changed.connect(self._show_values)
        self._run.changed.connect(self._start_or_stop)
        self._level.changed.connect(self._show_level)
        self._by_distance.changed.connect(self._show_level)
        self._viewer.layers.events.inserted.connect(self._layers_changed)
        self._viewer.layers.events.removed.connect(self._layers_changed)
        self._layers_changed()

    def _layers(self, _widget: Any = None) -> list[Any]:
        return [layer for layer in self._viewer.layers if isinstance(layer, (Image, Labels))]

    def _layers_changed(self, _event: Any = None) -> None:
        self._layer.reset_choices()
        if self._layer.value is None and self._layers():
            self._layer.value = self._layers()[0]
        self._show_values()

    def _show_values(self, _layer: Any = None) -> None:
        """Show the options of the chosen layer, with its range of values."""
        layer = self._layer.value
        has_labels = layer is not None and is_labels(layer)
        self._isovalue.visible = not has_labels
        self._label_number.visible = self._smooth.visible = has_labels
        self._run.enabled = layer is not None or self._worker is not None
        if layer is None:
            return
        if has_labels:
            self._label_number.value = max(1, int(layer.selected_label))
            return
        low, high = (float(limit) for limit in layer.contrast_limits_range)
        middle = 0.5 * (float(layer.contrast_limits[0]) + float(layer.contrast_limits[1]))
        # The value must be in the range at every step.
        self._isovalue.min = min(low, self._isovalue.min)
        self._isovalue.max = max(high, self._isovalue.max)
        self._isovalue.value = middle
        self._isovalue.min, self._isovalue.max = low, high
        self._isovalue.step = (high - low) / 1000 or 1.0

    def _start_or_stop(self) -> None:
        if self._worker is not None:
            self._worker.quit()
            return
        layer = self._layer.value
        value = self._label_number.value if is_labels(layer) else self._isovalue.value
        options: dict[str, Any] = {
            "value": value,
            "smooth": float(self._smooth.value),
            "step": tuple(self._viewer.dims.current_step)[-layer.ndim :],
            "levels": int(self._count.value),
            "max_distance": float(self._distance.value),
            "keep_components": int(self._keep.value) or None,
            "border": "closed" if self._closed.value else "open",
        }
        self._source, self._fraction = layer, 0.0
        worker: FunctionWorker[Mesh] = create_worker(
            mesh_layer, layer, progress=self._take_progress, _start_thread=False,
            _ignore_errors=True,  # _show_error handles them
            **options,
        )
        worker.returned.connect(self._show_mesh)
        worker.errored.connect(self._show_error)
        worker.finished.connect(self._finish)
        self._worker = worker
        self._run.text = "Stop"
        self._bar.value, self._bar.visible = 0, True
        self._timer.start(_POLL_INTERVAL)
        worker.start()

    def _take_progress(self, _stage: str, fraction: float) -> None:
        """Called in the thread of the work."""
        self._fraction = fraction
        if self._worker is not None and self._worker.abort_requested:
            raise _Stopped

    def _show_progress(self) -> None:
        self._bar.value = round(100 * self._fraction)

    def _show_error(self, error: Exception) -> None:
        if not isinstance(error, _Stopped):
            show_error(f"isoatlas: {error}")

    def _finish(self) -> None:
        self._worker = None
        self._timer.stop()
        self._bar.visible = False
        self._run.text = "Mesh"
        self._run.enabled = self._layer.value is not None

    def _show_mesh(self, mesh: Mesh) -> None:
        self._mesh, self._surface = mesh, None
        finest = len(mesh.levels) - 1
        with self._level.changed.blocked():
            self._level.max = finest
            self._level.value = finest
        self._level.enabled = finest > 0
        data, options, _kind = surface_data(
            self._source, mesh, color_by_distance=self._by_distance.value
        )
        self._surface = self._viewer.add_surface(data, **options)
        self._show_facts()

    def _show_level(self, _value: Any = None) -> None:
        if self._mesh is None or self._surface not in self._viewer.layers:
            return
        data, options, _kind = surface_data(
            self._source,
            self._mesh,
            int(self._level.value),
            color_by_distance=self._by_distance.value,
        )
        self._surface.data = data
        self._surface.colormap = options["colormap"]
        if "contrast_limits" in options:
            self._surface.contrast_limits = options["contrast_limits"]
        else:
            self._surface.reset_contrast_limits()
        self._show_facts()

    def _show_facts(self) -> None:
        assert self._mesh is not None
        level = self._mesh.levels[int(self._level.value)]
        report = level.report
        self._triangles.value = f"{len(level.faces):,}"
        topology = f"{_counted(report['components'], 'component')}, genus {report['genus']:,}"
        if report["boundary_loops"]:
            topology += f", {_counted(report['boundary_loops'], 'boundary loop')}"
        self._topology.value = topology
        self._within.value = _distance_text(report)


def _counted(count: int, noun: str) -> str:
    return f"{count:,} {noun}" + ("" if count == 1 else "s")


def _distance_text(report: dict[str, Any]) -> str:
    """The largest distance between mesh and isosurface, and how it is known."""
    proved = report.get("distance_at_most")
    if proved is not None:
        return f"{proved:.4g} (proved)"
    metrics = report.get("metrics")
    return f"{metrics['max_distance']['maximum']:.4g} (sampled)" if metrics else ""
