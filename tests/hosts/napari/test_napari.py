# SPDX-License-Identifier: Apache-2.0
"""The napari plugin in napari, with a window under Xvfb. ISOATLAS_PICTURE: a screenshot."""

import os
import pathlib
import re
import subprocess
import sys
import textwrap
import time

import numpy as np
import pytest

import isoatlas

napari = pytest.importorskip("napari", reason="napari is not installed")
from isoatlas.napari import mesh_layer, surface_data  # noqa: E402
from napari.layers import Image, Labels  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[3]
DATA = pathlib.Path(os.environ.get("ISOATLAS_TEST_DATA") or ROOT.parent / "shared" / "data")
try:
    import tomllib
except ImportError:  # Python 3.10
    tomllib = None


def ball(radius=6.0, shape=(18, 20, 22), center=(8, 9, 10)):
    return radius - np.linalg.norm(np.indices(shape).T - center, axis=-1).T


def enclosed(vertices, faces):
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    return np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6


def labels_of_two_balls():
    labels = np.zeros((18, 20, 40), np.int32)
    labels[ball(6, labels.shape) > 0] = 3
    labels[ball(5, labels.shape, (8, 9, 28)) > 0] = 7
    return labels


# ---------------------------------------------------------------------------- without a window


def test_image_layer():
    layer = Image(ball(), scale=(2, 0.5, 0.5), contrast_limits=(-1, 3))
    mesh = mesh_layer(layer, 0.0, max_distance=0.5, levels=3)
    assert len(mesh.levels) == 3
    expected = isoatlas.extract(
        ball(), 0.0, spacing=(2, 0.5, 0.5), order="ijk", levels=3, max_distance="0.5vx"
    )
    assert np.array_equal(mesh.vertices, expected.vertices)
    assert len(mesh_layer(layer, 0.0).levels) == 2
    (vertices, faces, values), options, kind = surface_data(layer, mesh)
    assert kind == "surface" and np.all(values == 1)
    assert np.allclose(vertices.mean(axis=0), (8, 9, 10), atol=0.5)  # in voxels
    assert np.allclose(options["scale"], (2, 0.5, 0.5))
    assert enclosed(vertices, faces) == pytest.approx(4 / 3 * np.pi * 216, rel=0.1)
    colored, options, _ = surface_data(layer, mesh, color_by_distance=True)
    assert 0 < colored[2].max() <= 0.25 and options["colormap"] == "viridis"


def test_caps():
    half = ball()[:9]  # cut through the middle of the ball
    layer = Image(half, scale=(2, 0.5, 0.5), contrast_limits=(-1, 3))
    assert mesh_layer(layer, 0.0).report["levels"][-1]["boundary_loops"] == 1
    (vertices, faces, _), _options, _kind = surface_data(
        layer, mesh_layer(layer, 0.0, border="closed")
    )
    edges, count = np.unique(
        np.sort(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)), axis=0, return_counts=True
    )
    assert len(edges) and np.all(count == 2)
    assert vertices[:, 0].max() == 8
    assert enclosed(vertices, faces) == pytest.approx(2 / 3 * np.pi * 216, rel=0.1)


def test_default_isovalue_is_in_the_middle_of_the_contrast_limits():
    layer = Image(ball(), contrast_limits=(-1, 3))
    assert np.array_equal(mesh_layer(layer).vertices, mesh_layer(layer, 1.0).vertices)


def test_surface_lies_in_the_image():
    viewer = napari.components.ViewerModel()
    layer = viewer.add_image(
        ball(), scale=(2, 0.5, 0.5), translate=(10, -4, 7), rotate=[[0.8, -0.6, 0], [0.6, 0.8, 0],
                                                                    [0, 0, 1]],
    )
    (data, options, _) = surface_data(layer, mesh_layer(layer, 0.0))
    surface = viewer.add_surface(data, **options)
    middle = surface.data_to_world(data[0].mean(axis=0))
    assert np.allclose(middle, layer.data_to_world((8, 9, 10)), atol=0.5)
    low, high = np.asarray(surface.extent.world)
    assert np.all(np.asarray(layer.extent.world)[0] <= low + 1e-6)
    assert np.all(high <= np.asarray(layer.extent.world)[1] + 1e-6)


def test_labels_layer():
    layer = Labels(labels_of_two_balls())
    layer.selected_label = 7
    mesh = mesh_layer(layer, max_distance=0.15)
    assert mesh.report["levels"][-1]["components"] == 1
    count = np.count_nonzero(layer.data == 7)
    # The Gaussian displaces a sphere of radius 5 inwards by about 0.2 voxels.
    assert enclosed(mesh.vertices, mesh.faces) == pytest.approx(count, rel=0.2)
    assert mesh.vertices[:, 2].min() > 20  # the other label is not meshed
    raw = mesh_layer(layer, 7, smooth=0, max_distance=0.15)
    assert len(raw.faces) > len(mesh.faces)  # the staircase of the voxels
    assert enclosed(raw.vertices, raw.faces) == pytest.approx(count, rel=0.05)
    with pytest.raises(isoatlas.BadArgumentError, match="no sample has the label 5; .* 0, 3, 7"):
        mesh_layer(layer, 5)


def test_time_series():
    moving = np.stack([ball(4), ball(6)])
    layer = Image(moving, scale=(1, 2, 1, 1), contrast_limits=(-1, 1))
    small = mesh_layer(layer, 0.0, step=(0, 8, 9, 10))
    large = mesh_layer(layer, 0.0, step=(1, 0, 0, 0))
    assert enclosed(large.vertices, large.faces) > 2 * enclosed(small.vertices, small.faces)
    _, options, _ = surface_data(layer, large)
    assert len(options["scale"]) == 3


def test_multiscale_images_use_the_finest_scale():
    fine = ball(12, (36, 40, 44), (16, 18, 20))
    layer = Image([fine, fine[::2, ::2, ::2]], multiscale=True, contrast_limits=(-1, 1))
    mesh = mesh_layer(layer, 0.0)
    assert enclosed(mesh.vertices, mesh.faces) == pytest.approx(4 / 3 * np.pi * 12**3, rel=0.1)


def test_what_cannot_be_meshed():
    with pytest.raises(isoatlas.UnsupportedError, match="RGB image has no isosurface"):
        mesh_layer(Image(np.zeros((6, 6, 6, 3), np.uint8), rgb=True), 0.5)
    with pytest.raises(isoatlas.UnsupportedError, match="2 dimensions, expected 3"):
        mesh_layer(Image(np.zeros((6, 6))), 0.5)
    with pytest.raises(isoatlas.EmptySurfaceError):
        mesh_layer(Image(ball()), 100.0)
    with pytest.raises(isoatlas.BadArgumentError, match="levels: expected a whole number from 1"):
        mesh_layer(Image(ball()), 0.0, levels=0)


def test_script_on_the_page(tmp_path, monkeypatch):
    (code,) = re.findall(
        r"(?ms)^```python\n(.*?)^```$", (ROOT / "docs/hosts/napari.md").read_text()
    )
    (tmp_path / "samples").symlink_to(ROOT / "samples")
    monkeypatch.chdir(tmp_path)
    names = {}
    exec(compile(code, "napari.md", "exec"), names)
    assert [layer.name for layer in names["viewer"].layers] == ["protein", "protein mesh"]
    assert (tmp_path / "protein.glb").is_file() and len(names["mesh"].levels) == 3


# ----------------------------------------------------------------------------------- the plugin


def test_isoatlas_does_not_import_napari():
    code = "import isoatlas, sys; print([m for m in sys.modules if 'napari' in m or 'qt' in m])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.stdout == "[]\n", done.stderr


def test_manifest_is_valid_and_is_found_by_its_entry_point(tmp_path):
    """As an installed package: npe2 finds the manifest and its commands can be imported."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    info = tmp_path / f"isoatlas-{isoatlas.__version__}.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(
        f"Metadata-Version: 2.1\nName: isoatlas\nVersion: {isoatlas.__version__}\n"
    )
    groups = project["entry-points"]
    (info / "entry_points.txt").write_text(
        "".join(
            f"[{group}]\n" + "".join(f"{key} = {value}\n" for key, value in entries.items())
            for group, entries in groups.items()
        )
    )
    code = """
        import npe2
        manager = npe2.PluginManager()
        manager.discover()
        manifest = manager.get_manifest("isoatlas")
        manifest.validate_imports()
        print(manifest.display_name, [w.display_name for w in manifest.contributions.widgets])
        print([c.id for c in manifest.contributions.commands])
    """
    done = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(code)],
        capture_output=True,
        text=True,
        env={
            **os.environ,
            "PYTHONPATH": f"{tmp_path}{os.pathsep}{os.environ['PYTHONPATH']}",
        },
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout == "Isoatlas ['Isosurface mesh']\n['isoatlas.mesh_layer']\n"


@pytest.fixture
def viewer():
    made = napari.Viewer(show=True)
    yield made
    made.close()


def wait_until(condition, seconds=60):
    from qtpy.QtWidgets import QApplication

    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "it takes too long"
        QApplication.processEvents()
        time.sleep(0.01)


def widget_in(viewer):
    import npe2

    manifest = npe2.PluginManifest.from_file(
        pathlib.Path(isoatlas.__file__).parent / "napari/napari.yaml"
    )
    manager = npe2.PluginManager.instance()
    if "isoatlas" not in manager:
        manager.register(manifest)
    _dock, widget = viewer.window.add_plugin_dock_widget("isoatlas", "Isosurface mesh")
    return widget


def run(widget, viewer):
    before = len(viewer.layers)
    widget._run.native.click()
    assert widget._run.text == "Stop"
    wait_until(lambda: widget._worker is None)
    assert len(viewer.layers) == before + 1 and widget._run.text == "Mesh"
    return viewer.layers[-1]


def test_widget_meshes_an_image(viewer):
    viewer.dims.ndisplay = 3
    viewer.add_image(ball(), name="ball", contrast_limits=(-2, 2))
    widget = widget_in(viewer)
    assert widget._layer.value is viewer.layers["ball"]
    wait_until(lambda: widget._isovalue.visible)
    assert not widget._label_number.visible
    assert widget._isovalue.value == pytest.approx(0, abs=0.02)
    surface = run(widget, viewer)
    assert surface.name == "ball mesh"
    assert widget._level.max == 3 and widget._level.value == 3 and widget._level.enabled
    finest = len(surface.faces)
    assert widget._triangles.value == f"{finest:,}" and "genus 0" in widget._topology.value
    assert widget._within.value.endswith(" (proved)")
    assert float(widget._within.value.split()[0]) <= 0.51
    widget._level.value = 0
    assert len(surface.faces) < finest and widget._triangles.value == f"{len(surface.faces):,}"
    widget._level.value = 3
    assert len(surface.faces) == finest
    widget._by_distance.value = True
    assert surface.colormap.name == "viridis" and surface.vertex_values.max() < 0.5
    widget._by_distance.value = False
    assert np.all(surface.vertex_values == 1)
    assert "loop" not in widget._topology.value


def test_widget_closes_the_mesh(viewer):
    viewer.add_image(ball()[:9], name="half", contrast_limits=(-2, 2))
    widget = widget_in(viewer)
    run(widget, viewer)
    assert widget._topology.value.endswith("1 boundary loop")
    widget._closed.value = True
    run(widget, viewer)
    assert "loop" not in widget._topology.value


def test_widget_follows_the_layers(viewer):
    widget = widget_in(viewer)
    assert widget._layer.value is None and not widget._run.enabled
    viewer.add_points(np.zeros((1, 3)))
    assert widget._layer.value is None
    viewer.add_labels(labels_of_two_balls(), name="cells")
    viewer.layers["cells"].selected_label = 7
    viewer.add_image(ball(), name="ball")
    assert [str(layer) for layer in widget._layer.choices if layer] == ["cells", "ball"]
    widget._layer.value = viewer.layers["ball"]
    widget._layer.value = viewer.layers["cells"]
    wait_until(lambda: widget._label_number.visible and widget._smooth.visible)
    assert not widget._isovalue.visible
    assert widget._label_number.value == 7
    surface = run(widget, viewer)
    assert surface.vertices[:, 2].min() > 20
    viewer.layers.remove(surface)
    widget._level.value = 0  # its layer is gone: nothing happens
    viewer.layers.remove("cells")
    assert widget._layer.value is viewer.layers["ball"]


def test_widget_reports_errors_and_stops(viewer, monkeypatch):
    from isoatlas.napari import _widget

    errors = []
    monkeypatch.setattr(_widget, "show_error", errors.append)
    viewer.add_labels(labels_of_two_balls(), name="cells")
    widget = widget_in(viewer)
    widget._label_number.value = 5
    widget._run.native.click()
    wait_until(lambda: widget._worker is None)
    assert len(errors) == 1 and "no sample has the label 5" in errors[0]
    rng = np.random.default_rng(1)
    viewer.add_image(rng.normal(size=(90, 90, 90)), name="noise")
    widget._layer.value = viewer.layers["noise"]
    widget._run.native.click()
    wait_until(lambda: widget._fraction > 0)
    widget._run.native.click()
    wait_until(lambda: widget._worker is None, 30)
    assert len(errors) == 1 and len(viewer.layers) == 2


def test_screenshot(viewer, tmp_path):
    """Real labels: a segmented brain, with the surface of one label."""
    if not (DATA / "labels/aseg.mgz").is_file():
        pytest.skip(f"no {DATA}/labels; set ISOATLAS_TEST_DATA to the folder of volumes")
    viewer.window.resize(1400, 850)
    volume = isoatlas.read(DATA / "labels/aseg.mgz")
    labels = viewer.add_labels(
        volume.array.astype(np.int32), name="aseg", scale=volume.spacing[::-1], opacity=0.25
    )
    labels.selected_label = 16  # brain stem
    viewer.dims.ndisplay = 3
    widget = widget_in(viewer)
    widget._keep.value = 1
    surface = run(widget, viewer)
    surface.wireframe.visible = True
    widget._level.value = 2
    widget._by_distance.value = True
    labels.visible = False
    viewer.camera.angles = (20, 35, -60)
    viewer.camera.center = surface.data_to_world(surface.vertices.mean(axis=0))
    viewer.camera.zoom *= 3
    wait_until(lambda: widget._triangles.value)
    picture = viewer.screenshot(canvas_only=False, flash=False)
    assert picture.shape[0] > 500 and len(np.unique(picture.reshape(-1, 4), axis=0)) > 500
    visible = viewer.screenshot(flash=False)
    surface.visible = False
    hidden = viewer.screenshot(flash=False)
    assert np.any(visible != hidden, axis=-1).mean() > 0.02
    if path := os.environ.get("ISOATLAS_PICTURE"):
        from imageio import imwrite

        imwrite(path, picture[..., :3])
