# SPDX-License-Identifier: Apache-2.0
"""isoatlas.dask with threads and with workers in processes of their own, one of which is killed."""

import os
import signal
import threading

import dask.array
import h5py
import numpy as np
import pytest
import zarr
from distributed import Client, LocalCluster

import isoatlas
import isoatlas.dask

OPTIONS = {"max_distance": "1vx", "spacing": (2.0, 1.0, 0.5), "order": "ijk"}


@pytest.fixture(scope="module")
def samples():
    """Noise on a gyroid: many components, tunnels and loops in each block."""
    z, y, x = np.mgrid[:26, :29, :32] / 4.0
    gyroid = np.sin(x) * np.cos(y) + np.sin(y) * np.cos(z) + np.sin(z) * np.cos(x)
    noise = np.random.default_rng(7).normal(scale=0.5, size=gyroid.shape)
    return (100 * (gyroid + noise)).astype(np.int16)


@pytest.fixture(scope="module")
def mesh(samples):
    return isoatlas.dask.extract(samples, 20.5, blocks=(12, 14, 16), **OPTIONS)


@pytest.fixture(scope="module")
def client():
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        with Client(cluster) as it:
            yield it


def assert_same(one, other):
    for a, b in zip(one.levels, other.levels, strict=True):
        np.testing.assert_array_equal(a.vertices, b.vertices)
        np.testing.assert_array_equal(a.faces, b.faces)


def test_topology_is_that_of_the_whole(samples, mesh):
    whole = isoatlas.extract(samples, 20.5, **OPTIONS)
    for level in mesh.report["levels"]:
        for key in ("components", "genus", "boundary_loops", "kinds"):
            assert level[key] == whole.report["reference"][key]
        assert level["self_intersections"] == 0
        assert level["certificate"]["passed"]
    assert mesh.report["blocks"]["counts"] == [2, 2, 3]
    assert mesh.report["blocks"]["seam_edges"] > 500
    low, high = whole.bounds
    np.testing.assert_allclose(mesh.bounds[0], low, atol=1e-6)
    np.testing.assert_allclose(mesh.bounds[1], high, atol=1e-6)


@pytest.mark.parametrize("order", ["ijk", "xyz"])
def test_orders_of_axes(samples, order):
    options = {"coarse": True, "spacing": (1.0, 2.0, 3.0), "order": order}
    one = isoatlas.dask.extract(samples, 20.5, blocks=100, **options)
    whole = isoatlas.extract(samples, 20.5, **options)
    np.testing.assert_array_equal(one.vertices, whole.vertices)
    np.testing.assert_array_equal(one.faces, whole.faces)


def test_arrays_of_all_kinds_in_other_processes(samples, mesh, client, tmp_path):
    stored = zarr.create_array(str(tmp_path / "a.zarr"), shape=samples.shape, chunks=(16, 16, 16),
                               dtype=samples.dtype)
    stored[:] = samples
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file.create_dataset("a", data=samples, chunks=(10, 29, 32))
    lazy = dask.array.from_array(samples, chunks=(13, 17, 32))
    options = {"blocks": (12, 14, 16), **OPTIONS}
    assert_same(isoatlas.dask.extract(lazy, 20.5, client=client, **options), mesh)
    assert_same(isoatlas.dask.extract(stored, 20.5, client=client, **options), mesh)
    with h5py.File(tmp_path / "a.h5") as file:
        assert_same(isoatlas.dask.extract(file["a"], 20.5, **options), mesh)


def test_a_killed_worker_costs_only_its_blocks(samples, mesh, client):
    done = []

    def progress(stage, fraction):
        assert stage == "blocks"
        if not done:
            pid = client.run(os.getpid)
            os.kill(sorted(pid.values())[0], signal.SIGKILL)
        done.append(fraction)

    lazy = dask.array.from_array(samples, chunks=(12, 14, 16))
    got = isoatlas.dask.extract(lazy, 20.5, blocks=(12, 14, 16), client=client, progress=progress,
                                **OPTIONS)
    assert_same(got, mesh)
    assert done[-1] == 1.0 and sorted(done) == done


@pytest.mark.parametrize("workers", [1, 4])
def test_any_number_of_workers_gives_the_same_mesh(samples, mesh, workers):
    with LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=None) as cluster:
        with Client(cluster) as client:
            lazy = dask.array.from_array(samples, chunks=(12, 14, 16))
            got = isoatlas.dask.extract(lazy, 20.5, blocks=(12, 14, 16), client=client, **OPTIONS)
    assert_same(got, mesh)


def damaged_arrays(samples, folder):
    """Arrays of each kind with one damaged chunk."""
    stored = zarr.create_array(str(folder / "a.zarr"), shape=samples.shape, chunks=(9, 10, 11),
                               dtype=samples.dtype)
    stored[:] = samples
    chunk = folder / "a.zarr" / "c" / "1" / "2" / "0"
    chunk.write_bytes(chunk.read_bytes()[:-40])
    with h5py.File(folder / "a.h5", "w") as file:
        data = file.create_dataset("a", data=samples, chunks=(9, 10, 11), compression="gzip",
                                   fletcher32=True)
        place = data.id.get_chunk_info_by_coord((9, 20, 0))
    with open(folder / "a.h5", "r+b") as file:
        file.seek(place.byte_offset + 20)
        file.write(b"damaged")

    def of_block(block, block_info=None):
        if block_info[0]["chunk-location"] == (1, 2, 0):
            raise RuntimeError("no such\nobject")
        return block

    return [stored, dask.array.from_zarr(stored), h5py.File(folder / "a.h5")["a"],
            dask.array.from_array(samples, chunks=(9, 10, 11)).map_blocks(
                of_block, dtype=samples.dtype)]


def test_a_damaged_chunk_is_named(samples, client, tmp_path):
    arrays = damaged_arrays(samples, tmp_path)
    for array in arrays:
        for scheduler in [None] if array is arrays[2] else [None, client]:
            with pytest.raises(isoatlas.BadFileError) as caught:
                isoatlas.dask.extract(array, 20.5, blocks=(12, 14, 16), client=scheduler, **OPTIONS)
            text = str(caught.value)
            assert text.startswith("chunk (1, 2, 0) of the array, samples [9:18, 20:29, 0:11], "
                                   "cannot be read: "), text
            assert "\n" not in text


def test_other_errors_of_an_array_are_its_own(samples):
    def of_block(block):
        raise KeyError("a bug in a pipeline")

    with pytest.raises(isoatlas.BadFileError, match=r"chunk \(0, 0, 0\).*KeyError: 'a bug in a"):
        isoatlas.dask.extract(dask.array.from_array(samples).map_blocks(of_block, dtype="i2"), 20.5)


def test_bad_arguments_are_refused(samples):
    with pytest.raises(isoatlas.BadArgumentError, match="blocks: expected 1 or 3 numbers"):
        isoatlas.dask.extract(samples, 20.5, blocks=(4, 4))
    with pytest.raises(isoatlas.BadArgumentError, match="expected 3 axes, got the shape"):
        isoatlas.dask.extract(samples[0], 20.5)
    with pytest.raises(TypeError, match="unexpected option 'isovalue'"):
        isoatlas.dask.extract(samples, 20.5, isovalue=3)
    with pytest.raises(isoatlas.UnsupportedError, match="cannot be had in blocks"):
        isoatlas.dask.extract(samples, 20.5, supersample=2)
    with pytest.raises(isoatlas.EmptySurfaceError, match="crosses none of the 1 blocks"):
        isoatlas.dask.extract(samples, 1e6)
    assert threading.active_count() < 50
