# SPDX-License-Identifier: Apache-2.0
"""Comparison with the function of the same name in scikit-image."""

import numpy as np
import pytest

import isoatlas
from conftest import enclosed_volume, torus

VOLUMES = {
    "float32": (torus(), 0.0),
    "float64": (torus(dtype=np.float64), 0.3),
    "uint8": ((100 + 20 * torus()).clip(0, 255).astype(np.uint8), 100.5),
    "Fortran": (np.asfortranarray(torus()), 0.0),
    "negative": (-torus(), 0.0),
}


def theirs(*arguments, **options):
    measure = pytest.importorskip("skimage.measure", reason="scikit-image is not installed")
    return measure.marching_cubes(*arguments, **options)


@pytest.mark.parametrize("direction", ["descent", "ascent"])
@pytest.mark.parametrize("name", VOLUMES)
def test_same_types_orientation_and_position(name, direction):
    volume, level = VOLUMES[name]
    ours = isoatlas.marching_cubes(volume, level, gradient_direction=direction)
    reference = theirs(volume, level, gradient_direction=direction)
    for mine, other in zip(ours, reference):
        assert mine.dtype == other.dtype and mine.shape[1:] == other.shape[1:]
    verts, faces, normals, values = ours
    assert len(verts) == len(normals) == len(values) < len(reference[0])
    assert np.abs(verts.min(0) - reference[0].min(0)).max() < 1
    assert np.abs(verts.max(0) - reference[0].max(0)).max() < 1
    # Larger triangles with corners on a round surface enclose less.
    expected = enclosed_volume(reference[0], reference[1])
    assert enclosed_volume(verts, faces) == pytest.approx(expected, rel=0.15)
    nearest = np.linalg.norm(verts[:, None] - reference[0][None], axis=2).argmin(axis=1)
    cosines = np.einsum("ij,ij->i", normals, reference[2][nearest])
    assert np.allclose(np.linalg.norm(normals, axis=1), 1, atol=1e-5)
    assert cosines.min() > 0.5 and cosines.mean() > 0.95


def test_values_are_maxima_of_the_grid_cell():
    volume, level = VOLUMES["float64"]
    verts, _, _, values = isoatlas.marching_cubes(volume, level)
    assert (values >= level - 1e-6).all() and values.max() <= volume.max()
    corners = tuple(slice(i, i + 2) for i in np.floor(verts[0]).astype(int))
    assert values[0] == np.float32(volume[corners].max())


def test_spacing():
    volume, _ = VOLUMES["float32"]
    plain = isoatlas.marching_cubes(volume, 0.0, spacing=(1, 1, 1))
    assert plain[0].dtype == np.float32
    spacing = np.array([0.5, 1.5, 3.0])
    ours, reference = (
        f(volume, 0.0, spacing=tuple(spacing)) for f in (isoatlas.marching_cubes, theirs)
    )
    assert ours[0].dtype == reference[0].dtype == np.float64
    assert np.abs(ours[0].max(0) - reference[0].max(0)).max() < 3
    # Normals in world coordinates agree with those of the triangles.
    a, b, c = (ours[0][ours[1][:, k]] for k in range(3))
    flat = np.cross(b - a, c - a)
    flat /= np.linalg.norm(flat, axis=1)[:, None]
    mean = -(ours[2][ours[1]].sum(axis=1) / 3)  # "descent": faces are clockwise seen from outside
    assert np.median(np.einsum("ij,ij->i", flat, mean)) > 0.9


def test_level_by_default():
    volume, _ = VOLUMES["float64"]
    ours = isoatlas.marching_cubes(volume)
    named = isoatlas.marching_cubes(volume, 0.5 * (volume.min() + volume.max()))
    assert np.array_equal(ours[0], named[0])
    wide = np.zeros((4, 4, 4), np.uint8)
    wide[1:3, 1:3, 1:3] = 255  # the sum of minimum and maximum must not overflow
    assert len(isoatlas.marching_cubes(wide + np.uint8(0))[1]) > 0


def test_step_size():
    volume = np.kron(torus(), np.ones((3, 3, 3), np.float32))
    ours, reference = (f(volume, 0.0, step_size=3) for f in (isoatlas.marching_cubes, theirs))
    assert np.abs(ours[0].max(0) - reference[0].max(0)).max() < 3
    assert enclosed_volume(*ours[:2]) == pytest.approx(enclosed_volume(*reference[:2]), rel=0.15)


def test_finer_on_request():
    volume, level = VOLUMES["float64"]
    coarse = isoatlas.marching_cubes(volume, level, coarse=True)
    fine = isoatlas.marching_cubes(volume, level, max_distance="0.1vx")
    assert len(coarse[0]) < len(isoatlas.marching_cubes(volume, level)[0]) < len(fine[0])
    refined = isoatlas.marching_cubes(volume, level, refine="max-distance:0.1vx")
    assert len(refined[0]) == len(fine[0])
    assert enclosed_volume(*fine[:2]) == pytest.approx(
        enclosed_volume(*theirs(volume, level)[:2]), rel=0.03
    )


def test_plateaus_have_normals():
    mask = torus() > 0
    normals = isoatlas.marching_cubes(mask, 0.5)[2]
    assert np.allclose(np.linalg.norm(normals, axis=1), 1, atol=1e-5)
    flat = np.zeros((8, 8, 8))
    flat[3, 3, 3] = 0.5  # a single sample, equal to the level: the gradient is 0
    normals = isoatlas.marching_cubes(flat, 0.5)[2]
    assert np.allclose(np.linalg.norm(normals, axis=1), 1, atol=1e-5)


def test_positional_and_four_results():
    verts, faces, normals, values = isoatlas.marching_cubes(
        *VOLUMES["float32"], allow_degenerate=False, method="lorensen"
    )
    assert faces.max() == len(verts) - 1


def test_nan():
    volume = torus()
    volume[0, 0, 0] = np.nan
    with pytest.raises(ValueError, match="nan='below'"):
        isoatlas.marching_cubes(volume, 0.0)
    assert np.isfinite(isoatlas.marching_cubes(volume, 0.0, nan="below")[2]).all()


@pytest.mark.parametrize(
    ("options", "error"),
    [
        ({"level": 100.0}, ValueError),
        ({"level": -100.0}, ValueError),
        ({"spacing": (1, 1)}, ValueError),
        ({"step_size": 0}, ValueError),
        ({"step_size": 25}, ValueError),
        ({"gradient_direction": "up"}, ValueError),
        ({"method": "x"}, ValueError),
        ({"mask": np.ones((26, 22, 14), bool)}, NotImplementedError),
    ],
)
def test_bad_arguments_are_refused(options, error):
    with pytest.raises(error):
        isoatlas.marching_cubes(torus(), **options)


def test_arrays_that_are_not_volumes():
    for array in (np.zeros((4, 4)), np.zeros((1, 4, 4)), np.zeros((0, 4, 4))):
        with pytest.raises(ValueError):
            isoatlas.marching_cubes(array)


def test_default_level_ignores_samples_that_are_not_finite():
    field = torus()
    expected = isoatlas.marching_cubes(field)
    field[0, 0, 0] = np.nan
    with pytest.raises(isoatlas.UnsupportedError, match="1 NaN"):
        isoatlas.marching_cubes(field)
    found = isoatlas.marching_cubes(field, nan="below")
    assert np.array_equal(found[0], expected[0]) and np.array_equal(found[1], expected[1])
    with pytest.raises(isoatlas.BadArgumentError, match="^level: expected a finite number"):
        isoatlas.marching_cubes(torus(), float("nan"))


def test_spacing_of_a_volume_is_in_the_other_order():
    volume = isoatlas.Volume(torus(), spacing=(1, 2, 3))
    with pytest.raises(isoatlas.BadArgumentError, match="order of the array's axes: spacing=vol"):
        isoatlas.marching_cubes(volume.array, 0.0, spacing=volume.spacing)
    vertices, *_ = isoatlas.marching_cubes(volume.array, 0.0, spacing=volume.spacing[::-1])
    expected = isoatlas.extract(volume, 0.0).vertices
    assert np.allclose(vertices[:, ::-1].min(axis=0), expected.min(axis=0), atol=1)
