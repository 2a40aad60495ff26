# SPDX-License-Identifier: Apache-2.0
"""Arrays of all kinds: used without a copy, copied, or refused; never rounded."""

import tracemalloc

import numpy as np
import pytest

import isoatlas
from conftest import torus
from isoatlas._arrays import as_samples


def scaled(dtype):
    """The torus with values around 40, in any type."""
    return np.round(40 + 8 * torus(dtype=np.float64)).clip(0, 100).astype(dtype)


REFERENCE = isoatlas.extract(scaled(np.float64), 40.5)


def gives_reference_mesh(array):
    mesh = isoatlas.extract(array, 40.5)
    return (
        mesh.vertices.tobytes() == REFERENCE.vertices.tobytes()
        and mesh.faces.tobytes() == REFERENCE.faces.tobytes()
    )


@pytest.mark.parametrize("code", [*"bBhHiIlLqQefdg"])
def test_every_numeric_type(code):
    assert gives_reference_mesh(scaled(np.dtype(code)))


@pytest.mark.parametrize("code", ["<i2", ">i2", ">u4", ">i8", ">f2", ">f4", ">f8"])
def test_every_byte_order(code):
    assert gives_reference_mesh(scaled(np.dtype(code)))


def test_native_types_keep_their_name():
    for name in "int8 uint8 int16 uint16 int32 uint32 int64 uint64 float32 float64".split():
        mesh = isoatlas.extract(scaled(name), 40.5, coarse=True)
        assert mesh.report["input"]["sample_type"] == name


def test_bool_is_0_and_1():
    mask = torus() > 0
    mesh = isoatlas.extract(mask, 0.5)
    other = isoatlas.extract(mask.astype(np.uint8), 0.5)
    assert mesh.vertices.tobytes() == other.vertices.tobytes()


def strided():
    big = np.zeros((52, 44, 28))
    big[::2, ::2, ::2] = scaled(np.float64)
    return big[::2, ::2, ::2]


def padded():
    big = np.full((28, 30, 20), np.nan)
    big[1:27, 5:27, 3:17] = scaled(np.float64)
    return big[1:27, 5:27, 3:17]


def misaligned():
    array = scaled(np.float64)
    buffer = np.zeros(array.nbytes + 1, np.uint8)
    view = buffer[1:].view(np.float64).reshape(array.shape)
    view[...] = array
    assert not view.flags.aligned
    return view


def field_of_records():
    records = np.zeros(scaled(np.float32).shape, dtype=[("a", "u1"), ("value", "<f4")])
    records["value"] = scaled(np.float32)
    return records["value"]


LAYOUTS = {
    "strided": strided,
    "padded": padded,
    "misaligned": misaligned,
    "field of records": field_of_records,
    "negative strides": lambda: scaled(np.int16)[::-1, :, ::-1].copy()[::-1, :, ::-1],
    "broadcast": lambda: np.broadcast_to(scaled(np.int16)[np.newaxis], (1, 26, 22, 14))[0],
    "read-only": lambda: np.frombuffer(scaled(np.int16).tobytes(), np.int16).reshape(26, 22, 14),
    "nested lists": lambda: scaled(np.int16).tolist(),
    "masked array without masked samples": lambda: np.ma.masked_array(scaled(np.int16), mask=False),
    "matrix-like": lambda: np.asarray(scaled(np.int16)).view(np.recarray),
}


@pytest.mark.parametrize("name", LAYOUTS)
def test_every_layout(name):
    array = LAYOUTS[name]()
    before = np.array(array)
    assert gives_reference_mesh(array)
    assert np.array_equal(before, np.array(array))  # extract() must not change its input


def test_axis_with_stride_zero():
    flat = np.broadcast_to(scaled(np.float64)[:, :, 6:7], (26, 22, 14))
    a, b = isoatlas.extract(flat, 40.5), isoatlas.extract(np.ascontiguousarray(flat), 40.5)
    assert a.vertices.tobytes() == b.vertices.tobytes() and a.levels[0].report["boundary_loops"] > 0


def test_memory_map(tmp_path):
    np.save(tmp_path / "v.npy", scaled(np.int16))
    mapped = np.load(tmp_path / "v.npy", mmap_mode="r")
    assert np.shares_memory(as_samples(mapped), mapped)
    assert gives_reference_mesh(mapped)


def peak_numpy_bytes(work):
    tracemalloc.start()
    try:
        work()
        _, peak = tracemalloc.get_traced_memory()  # numpy reports its allocations to tracemalloc
        return peak
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize("dtype", ["uint8", "int16", "float32", "float64", "bool"])
def test_dense_arrays_are_not_copied(dtype):
    ball = 30 - np.linalg.norm(np.indices((80, 81, 82)).T - (40.3, 40.2, 39.1), axis=-1)
    array = np.ascontiguousarray(ball > 0 if dtype == "bool" else (ball + 50).astype(dtype))
    iso = 0.5 if dtype == "bool" else 50.5
    views = {"C": array, "Fortran": array.T, "transposed": array.transpose(1, 2, 0)}
    for name, view in views.items():
        assert np.shares_memory(as_samples(view), array), name
        used = peak_numpy_bytes(lambda: isoatlas.extract(view, iso, coarse=True))
        assert used < array.nbytes / 4, (name, used)
    used = peak_numpy_bytes(lambda: isoatlas.extract(array[::-1], iso, coarse=True))
    assert array.nbytes <= used < 1.5 * array.nbytes  # negative stride: one copy


def test_64_bit_integers_are_not_rounded():
    low = 2**60
    for dtype in (np.int64, np.uint64):
        array = np.full((6, 6, 6), low, dtype)
        array[2:4, 2:4, 2:4] = low + 1  # the same double as `low`
        with pytest.raises(isoatlas.EmptySurfaceError):
            isoatlas.extract(array, low - 512)
        with pytest.raises(
            isoatlas.BadArgumentError,
            match=f"iso: expected a number that is a float64, got {low + 1}",
        ):
            isoatlas.extract(array, low + 1)


def test_long_doubles_must_be_exact_doubles():
    array = scaled(np.longdouble)
    if array.dtype.itemsize == 8:
        pytest.skip("longdouble is double here")
    array[3, 4, 5] += np.finfo(np.longdouble).eps * 64
    with pytest.raises(
        isoatlas.UnsupportedError, match=r"that float64 cannot hold, the first at index \(3, 4, 5\)"
    ):
        isoatlas.extract(array, 40.5)
    array[3, 4, 5] = np.nan
    assert as_samples(array).dtype == np.float64


@pytest.mark.parametrize(
    ("array", "message"),
    [
        (np.zeros((4, 4)), r"the array has 2 dimensions \(4, 4\), expected 3"),
        (np.zeros((2, 3, 4, 5)), "the array has 4 dimensions"),
        (7, "the array has 0 dimensions"),
        (
            np.zeros((4, 4, 4), complex),
            "samples of type complex128, expected bool, integers or floating-point numbers",
        ),
        (np.zeros((4, 4, 4), object), "samples of type object"),
        (np.zeros((4, 4, 4), "datetime64[s]"), "samples of type datetime64"),
        (np.zeros((4, 4, 4), "U3"), "samples of type <U3"),
        (np.zeros((4, 4, 4), [("a", "f4")]), "samples of type"),
        (
            np.ma.masked_less(np.arange(64.0).reshape(4, 4, 4), 3),
            "the array has 3 masked samples, expected none",
        ),
    ],
)
def test_unsupported_arrays_are_refused(array, message):
    with pytest.raises(isoatlas.UnsupportedError, match=message):
        isoatlas.extract(array, 0.5)


@pytest.mark.parametrize(
    "shape", [(0, 4, 4), (4, 0, 4), (4, 4, 0), (1, 4, 4), (4, 1, 4), (4, 4, 1), (0, 0, 0)]
)
def test_fewer_than_two_samples_along_an_axis(shape):
    for array in (np.zeros(shape), np.zeros(shape, order="F")):
        with pytest.raises(isoatlas.BadArgumentError):
            isoatlas.extract(array, 0.5)


def test_two_samples_along_each_axis_are_enough():
    array = np.zeros((2, 2, 2))
    array[0, 1, 0] = 1
    assert len(isoatlas.extract(array, 0.5, coarse=True).faces) > 0


@pytest.mark.parametrize("order", "CF")
def test_nan_is_counted_and_located(order):
    array = np.array(scaled(np.float32), order=order)
    array[3, 4, 5] = np.nan
    array[3, 4, 6] = np.inf
    with pytest.raises(isoatlas.UnsupportedError) as raised:
        isoatlas.extract(array, 40.5)
    assert str(raised.value) == (
        "1 NaN and 1 infinite samples, the first at index (3, 4, 5): "
        "set nan='below' or nan='above', the side of the isovalue on which NaN lies"
    )
    with pytest.raises(isoatlas.UnsupportedError, match=r"\(5, 4, 3\)"):
        isoatlas.extract(array, 40.5, order="xyz")
    assert len(isoatlas.extract(array, 40.5, nan="below").faces) > 0
