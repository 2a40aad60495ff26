# SPDX-License-Identifier: Apache-2.0
"""Writes files in many variants with nibabel, tifffile, pynrrd, mrcfile, VTK and numpy.

The variants differ in sample type, byte order, compression and axes. Each writer yields the paths
of its files, which `independent.read` reads.
"""

import itertools

import numpy as np

TYPES = ("u1", "i1", "u2", "i2", "u4", "i4", "u8", "i8", "f4", "f8")
SHAPE = (5, 6, 7)  # z, y, x


def samples(dtype, seed=0):
    random = np.random.default_rng(seed)
    values = random.integers(0, 120, SHAPE)
    return (values if np.dtype(dtype).kind == "u" else values - 60).astype(dtype)


def tiff_types(folder):
    import tifffile

    for dtype, order, is_big in itertools.product((*TYPES, "f2"), "<>", (False, True)):
        path = folder / f"type_{dtype}_{'le' if order == '<' else 'be'}_{int(is_big)}.tif"
        tifffile.imwrite(
            path, samples(dtype), byteorder=order, bigtiff=is_big, photometric="minisblack"
        )
        yield path


def tiff_compressions(folder):
    import tifffile

    compressions = ("zlib", "lzma", "packbits", "lzw", "zstd")
    for compression, predictor, tile in itertools.product(
        compressions, (None, 2, 3), (None, (16, 16))
    ):
        path = folder / f"compressed_{compression}_{predictor}_{bool(tile)}.tif"
        dtype = "f4" if predictor == 3 else "u2"
        if predictor and compression == "packbits":
            continue  # refused: libtiff does not undo the predictor
        try:
            tifffile.imwrite(
                path, samples(dtype), compression=compression, predictor=predictor, tile=tile,
                photometric="minisblack",
            )
            tifffile.imread(path)
        except (ImportError, ValueError, KeyError, NotImplementedError):
            continue  # needs a package that is not installed
        yield path


def tiff_of_imagej(folder):
    import tifffile

    for dtype, unit in itertools.product(("u1", "u2", "f4"), ("um", "nm", "cm")):
        path = folder / f"imagej_{dtype}_{unit}.tif"
        metadata = {"axes": "ZYX", "spacing": 0.7, "unit": unit}
        tifffile.imwrite(
            path, np.abs(samples(dtype)), imagej=True, resolution=(4, 5), metadata=metadata
        )
        yield path


def nifti(folder):
    import nibabel

    oblique = np.array(
        [[0.8, 0.1, -0.2, 4], [-0.1, 0.9, 0.3, -7], [0.2, -0.3, 1.9, 2], [0, 0, 0, 1.0]]
    )
    rotation, _ = np.linalg.qr(oblique[:3, :3])
    for (name, kind), dtype, order, sign in itertools.product(
        (("1", nibabel.Nifti1Image), ("2", nibabel.Nifti2Image)), TYPES, "<>", (1, -1)
    ):
        affine = np.eye(4)
        affine[:3, :3] = rotation * np.array([0.8, 1.1, 2.5 * sign])
        affine[:3, 3] = (4, -7, 2)
        header = kind.header_class(endianness=order)
        header.set_data_dtype(np.dtype(dtype).newbyteorder(order))
        image = kind(samples(dtype).transpose(2, 1, 0), affine, header)
        image.header.set_xyzt_units("mm")
        byte_order = "le" if order == "<" else "be"
        ending = "r.nii.gz" if sign > 0 else "l.nii"
        path = folder / f"n{name}_{dtype}_{byte_order}_{ending}"
        image.to_filename(path)
        yield path


def mgh(folder):
    import nibabel

    for dtype in ("u1", "i2", "i4", "f4"):
        path = folder / f"m_{dtype}.mgz"
        affine = np.diag([0.5, -1, 2, 1.0])
        nibabel.MGHImage(samples(dtype).transpose(2, 1, 0), affine).to_filename(path)
        yield path


def nrrd(folder):
    import nrrd as pynrrd

    spaces = ("left-posterior-superior", "right-anterior-superior", "left-anterior-superior")
    encodings = ("raw", "gzip", "bzip2", "text")
    for dtype, encoding, space in itertools.product(TYPES, encodings, spaces):
        path = folder / f"r_{dtype}_{encoding}_{space[:7]}.nrrd"
        header = {
            "space": space,
            "space directions": [[0.8, 0, 0.1], [0, 1.1, 0], [-0.2, 0, 1.6]],
            "space origin": [1, -2, 3],
            "encoding": encoding,
        }
        pynrrd.write(str(path), samples(dtype).transpose(2, 1, 0), header)
        yield path


def mrc(folder):
    import mrcfile

    for dtype in ("i1", "i2", "u2", "f4"):
        path = folder / f"c_{dtype}.mrc"
        with mrcfile.new(path) as file:
            file.set_data(samples(dtype))
            file.set_volume()
            file.voxel_size = (1.5, 2.5, 3.5)
        yield path


def npy(folder):
    for dtype, order in itertools.product((*TYPES, "f2"), "<>"):
        path = folder / f"y_{dtype}_{'le' if order == '<' else 'be'}.npy"
        np.save(path, samples(dtype).astype(np.dtype(dtype).newbyteorder(order)))
        yield path


def vtk_xml(folder):
    import vtk
    from vtk.util.numpy_support import numpy_to_vtk

    compressors = {
        "none": None,
        "zlib": vtk.vtkZLibDataCompressor,
        "lz4": vtk.vtkLZ4DataCompressor,
        "lzma": vtk.vtkLZMADataCompressor,
    }
    modes = {
        "text": vtk.vtkXMLWriter.Ascii,
        "inline": vtk.vtkXMLWriter.Binary,
        "appended": vtk.vtkXMLWriter.Appended,
    }
    for dtype, (mode, mode_value), (compression, compressor) in itertools.product(
        ("u1", "i2", "u4", "f4", "f8"), modes.items(), compressors.items()
    ):
        image = vtk.vtkImageData()
        image.SetExtent(3, 3 + SHAPE[2] - 1, -2, -2 + SHAPE[1] - 1, 0, SHAPE[0] - 1)
        image.SetSpacing(0.5, 0.75, 2)
        image.SetOrigin(1, 2, 3)
        values = numpy_to_vtk(samples(dtype).ravel(), deep=True)
        values.SetName("v")
        image.GetPointData().SetScalars(values)
        writer = vtk.vtkXMLImageDataWriter()
        path = folder / f"v_{dtype}_{mode}_{compression}.vti"
        writer.SetFileName(str(path))
        writer.SetInputData(image)
        writer.SetDataMode(mode_value)
        writer.SetCompressor(compressor() if compressor else None)
        writer.Write()
        yield path


def vtk_legacy(folder):
    import vtk
    from vtk.util.numpy_support import numpy_to_vtk

    for dtype, is_text in itertools.product(("u1", "i2", "u4", "f4", "f8"), (False, True)):
        image = vtk.vtkImageData()
        image.SetDimensions(SHAPE[2], SHAPE[1], SHAPE[0])
        image.SetSpacing(0.5, 0.75, 2)
        image.SetOrigin(1, 2, 3)
        values = numpy_to_vtk(samples(dtype).ravel(), deep=True)
        values.SetName("v")
        image.GetPointData().SetScalars(values)
        writer = vtk.vtkStructuredPointsWriter()
        path = folder / f"l_{dtype}_{is_text}.vtk"
        writer.SetFileName(str(path))
        writer.SetInputData(image)
        writer.SetFileTypeToASCII() if is_text else writer.SetFileTypeToBinary()
        if dtype == "i2":  # EXTENT instead of DIMENSIONS
            image.SetExtent(-2, SHAPE[2] - 3, 3, SHAPE[1] + 2, 1, SHAPE[0])
            writer.SetWriteExtent(True)
        writer.Write()
        yield path


WRITERS = (
    tiff_types, tiff_compressions, tiff_of_imagej, nifti, mgh, nrrd, mrc, npy, vtk_xml, vtk_legacy,
)
