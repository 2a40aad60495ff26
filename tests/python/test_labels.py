# SPDX-License-Identifier: Apache-2.0
"""Segmentations: `mask_field`, and `extract` with a label."""
import numpy as np
import pytest

import isoatlas


def ball(shape=(24, 26, 28), radius=8.0, spacing=(1.0, 1.0, 1.0)):
    index = np.indices(shape, dtype=float)
    centre = [(n - 1) / 2 + 0.2 for n in shape]
    squares = [(s * (i - c)) ** 2 for i, c, s in zip(index, centre, spacing)]
    return sum(squares) <= radius**2


@pytest.mark.parametrize("order", ["C", "F"])
@pytest.mark.parametrize("dtype", [bool, np.uint8, np.int64, np.float32])
def test_every_sample_keeps_its_side(dtype, order):
    mask = np.asarray(ball(), dtype=dtype, order=order)
    field = isoatlas.mask_field(mask, 1)
    assert field.dtype == np.float32 and field.shape == mask.shape
    assert np.array_equal(field > 0, mask != 0)


def test_the_mesh_of_a_label_is_that_of_its_field():
    labels = np.where(ball(), 7, 0)
    labels[:, :, :10] *= 2
    mesh = isoatlas.extract(labels, label=[7, 14])
    field = isoatlas.mask_field(labels, [7, 14])
    same = isoatlas.extract(field, 0, topology="faces")
    assert np.array_equal(mesh.vertices, same.vertices) and np.array_equal(mesh.faces, same.faces)
    assert mesh.volume == pytest.approx(4 / 3 * np.pi * 8**3, rel=0.12)


def test_thick_slices_of_a_volume():
    spacing = (1.0, 1.0, 4.0)
    mask = ball((8, 24, 24), 9, spacing[::-1])
    volume = isoatlas.Volume(mask.astype(np.uint8), spacing, (5, 6, 7))
    field = isoatlas.mask_field(volume, 1)
    assert isinstance(field, isoatlas.Volume) and field.spacing == spacing
    mesh = isoatlas.extract(volume, label=1, max_distance="0.2vx")
    assert mesh.volume == pytest.approx(mask.sum() * 4, rel=0.1)
    same = isoatlas.extract(mask, label=1, spacing=spacing, origin=(5, 6, 7), order="xyz",
                            max_distance="0.2vx")
    assert np.array_equal(mesh.vertices, same.vertices)


def test_samples_that_touch_at_an_edge():
    mask = np.zeros((5, 5, 5), np.uint8)
    mask[2, 2, 2] = mask[2, 3, 3] = 1
    for connectivity, components in [(18, 1), (6, 2)]:
        field = isoatlas.mask_field(mask, 1, connectivity=connectivity)
        mesh = isoatlas.extract(field, 0, topology="faces")
        assert len(mesh.components) == components


def test_errors():
    labels = ball().astype(np.uint8)
    with pytest.raises(isoatlas.EmptySurfaceError, match="no sample has the label 3; the labels"):
        isoatlas.extract(labels, label=3)
    with pytest.raises(isoatlas.UnsupportedError, match="expected whole numbers"):
        isoatlas.extract(labels + 0.5, label=1)
    with pytest.raises(isoatlas.BadArgumentError, match="expected a whole number or several"):
        isoatlas.extract(labels, label=1.5)
    with pytest.raises(isoatlas.BadArgumentError, match="iso: expected an isovalue, or the label"):
        isoatlas.extract(labels)
    with pytest.raises(isoatlas.BadArgumentError, match="iso: expected an isovalue, or the label"):
        isoatlas.extract(labels, 0.5, label=1)
    with pytest.raises(isoatlas.BadArgumentError, match="inside: not for a label"):
        isoatlas.extract(labels, label=1, inside="below")
    with pytest.raises(isoatlas.BadArgumentError, match="connectivity: expected 18, 6"):
        isoatlas.mask_field(labels, 1, connectivity=26)
