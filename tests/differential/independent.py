# SPDX-License-Identifier: Apache-2.0
"""Reads volumes by independent programs.

They are nibabel, pydicom, tifffile, pynrrd, mrcfile, VTK and numpy.

`read` returns samples indexed [x, y, z] and the 4 x 4 matrix from sample indices to the world in
LPS. Lengths are in the unit that isoatlas uses for the format: millimetres for NIfTI and DICOM, the
file's own unit for the others.
"""

import pathlib

import numpy as np

LPS_FROM_RAS = np.diag([-1.0, -1.0, 1.0, 1.0])


def matrix(spacing=(1, 1, 1), origin=(0, 0, 0), direction=np.eye(3)):
    """The matrix of a grid; `direction` has the axes as columns."""
    affine = np.eye(4)
    affine[:3, :3] = np.asarray(direction, float) * np.asarray(spacing, float)
    affine[:3, 3] = origin
    return affine


def nifti(path, time=0, **_):
    import gzip

    import nibabel

    path = pathlib.Path(path)
    content = path.read_bytes()
    content = gzip.decompress(content) if content[:2] == b"\x1f\x8b" else content
    is_nifti2 = content[:4] in (b"\x1c\x02\0\0", b"\0\0\x02\x1c")
    kind = nibabel.Nifti2Image if is_nifti2 else nibabel.Nifti1Image
    image = kind.from_bytes(content)
    samples = np.asarray(image.dataobj)
    samples = samples.reshape(samples.shape[:3] + (-1,))[..., time]
    unit = image.header.get_xyzt_units()[0]
    in_mm = {"meter": 1000, "mm": 1, "micron": 0.001, "unknown": 1}[unit]
    return samples, LPS_FROM_RAS @ np.diag([in_mm] * 3 + [1]) @ image.affine


def mgh(path, **_):
    import nibabel

    image = nibabel.load(path)
    return np.asarray(image.dataobj).squeeze(), LPS_FROM_RAS @ image.affine


def nrrd(path, layer=None, **_):
    import nrrd as pynrrd

    samples, header = pynrrd.read(str(path))
    space = header.get("space", "")
    directions = header.get("space directions")
    if directions is not None:
        in_space = [d for d in directions if not np.any(np.isnan(np.atleast_1d(d)))]
        directions = np.array(in_space, float)
    if layer is not None:
        samples = samples[layer]
    if directions is not None:
        affine = matrix(direction=directions.T, origin=header.get("space origin", (0, 0, 0)))
    else:
        affine = matrix(spacing=nrrd_spacings(header))
    sign = {
        "left": 1, "right": -1, "posterior": 1, "anterior": -1, "superior": 1, "inferior": -1,
    }
    short = {"LPS": "left-posterior", "RAS": "right-anterior", "LAS": "left-anterior"}
    words = short.get(space, space).replace("-time", "").split("-")
    if len(words) >= 2 and words[0] in sign:
        affine = np.diag([sign[words[0]], sign[words[1]], 1, 1]) @ affine
    return samples, affine


def nrrd_spacings(header):
    if "spacings" in header:
        return np.nan_to_num(np.asarray(header["spacings"], float), nan=1)
    if "axis mins" in header and "axis maxs" in header:
        centerings = header.get("centers", header.get("centerings", ["cell"] * 3))
        cells = np.array([c != "node" for c in centerings])
        lengths = np.array(header["axis maxs"]) - np.array(header["axis mins"])
        return lengths / (np.array(header["sizes"]) - ~cells)
    return (1, 1, 1)


def meta_image(path, **_):
    """Reads a MetaImage without a library: a text header, and samples by numpy."""
    import gzip
    import zlib

    path = pathlib.Path(path)
    content = path.read_bytes()
    end = content.index(b"\n", content.index(b"ElementDataFile")) + 1
    lines = content[:end].decode("latin-1").replace("\r", "").splitlines()
    fields = dict(line.split(" = ", 1) for line in lines if " = " in line)
    names = {
        "MET_CHAR": "i1", "MET_UCHAR": "u1", "MET_SHORT": "i2", "MET_USHORT": "u2",
        "MET_INT": "i4", "MET_UINT": "u4", "MET_FLOAT": "f4", "MET_DOUBLE": "f8",
    }
    is_big_endian = fields.get("BinaryDataByteOrderMSB", fields.get("ElementByteOrderMSB", "False"))
    order = ">" if is_big_endian.lower() == "true" else "<"
    size = tuple(map(int, fields["DimSize"].split()))
    where = fields["ElementDataFile"].strip()
    if where == "LOCAL":
        bytes_ = content[end:]
    elif where.startswith("LIST"):
        names_of_files = content[end:].decode().split()
        bytes_ = b"".join((path.parent / name).read_bytes() for name in names_of_files)
    else:
        bytes_ = (path.parent / where).read_bytes()
    if fields.get("CompressedData", "False").lower() == "true":
        bytes_ = gzip.decompress(bytes_) if bytes_[:2] == b"\x1f\x8b" else zlib.decompress(bytes_)
    dtype = np.dtype(order + names[fields["ElementType"].strip()])
    samples = np.frombuffer(bytes_[: int(np.prod(size)) * dtype.itemsize], dtype)
    samples = samples.reshape(size, order="F")

    def numbers(key, default):
        return np.array(fields[key].split(), float) if key in fields else default

    direction = numbers("TransformMatrix", np.eye(3).ravel()).reshape(3, 3).T
    origin = numbers("Offset", numbers("Origin", np.zeros(3)))
    return samples, matrix(numbers("ElementSpacing", np.ones(3)), origin, direction)


def tiff(path, channel=0, time=0, **_):
    import re

    import tifffile

    with tifffile.TiffFile(path) as file:
        series = file.series[0]
        samples = series.asarray()
        axes = series.axes.upper().replace("I", "Z").replace("Q", "Z").replace("S", "C")
        for axis, index in (("T", time), ("C", channel)):
            if axis in axes:
                samples = np.take(samples, index, axes.index(axis))
                axes = axes.replace(axis, "")
        assert axes == "ZYX", axes
        spacing = [1.0, 1.0, 1.0]
        if file.is_ome:
            pixels = re.search(r"<Pixels[^>]*>", file.ome_metadata).group()
            for i, axis in enumerate("XYZ"):
                found = re.search(rf'PhysicalSize{axis}="([^"]*)"', pixels)
                spacing[i] = float(found.group(1)) if found else 1.0
        elif file.is_imagej:
            meta = file.imagej_metadata or {}
            page = file.pages[0]
            for i, tag in enumerate(("XResolution", "YResolution")):
                if tag in page.tags and page.tags[tag].value[0] > 0:
                    over, under = page.tags[tag].value
                    spacing[i] = under / over
            spacing[2] = abs(float(meta.get("spacing", 1.0)))
            text = page.description
            c0 = re.search(r"^c0=(\S+)$", text, re.M)
            c1 = re.search(r"^c1=(\S+)$", text, re.M)
            if re.search(r"^cf=0$", text, re.M) and c0 and c1:
                samples = samples.astype(np.float64) * float(c1.group(1)) + float(c0.group(1))
    return samples.transpose(2, 1, 0), matrix(spacing)


def image_slices(folder, **_):
    import re

    import tifffile

    def by_number(path):
        return [int(t) if t.isdigit() else t for t in re.split(r"(\d+)", path.name)]

    names = sorted(pathlib.Path(folder).iterdir(), key=by_number)
    return np.stack([tifffile.imread(name) for name in names]).transpose(2, 1, 0), matrix()


def dicom(folder, series=None, **_):
    """Reads classic and enhanced images, sorted along the normal."""
    import pydicom

    folder = pathlib.Path(folder)
    paths = [folder]
    if folder.is_dir():
        paths = sorted(p for p in folder.rglob("*") if p.is_file())
    frames = []
    for path in paths:
        data = pydicom.dcmread(path, force=True)
        if "PixelData" in data:
            frames += list(dicom_frames(data))
    frames.sort(key=lambda f: float(np.dot(np.cross(*f["axes"]), f["position"])))
    samples = np.stack([f["samples"] for f in frames]).transpose(2, 1, 0)
    first, last = frames[0], frames[-1]
    step = (last["position"] - first["position"]) / (len(frames) - 1)
    affine = np.eye(4)
    affine[:3, 0] = first["axes"][0] * first["spacing"][1]
    affine[:3, 1] = first["axes"][1] * first["spacing"][0]
    affine[:3, 2] = step
    affine[:3, 3] = first["position"]
    return samples, affine


def dicom_frames(data):
    pixels = data.pixel_array
    if pixels.ndim == 2:
        pixels = pixels[None]
    shared = None
    if "SharedFunctionalGroupsSequence" in data:
        shared = data.SharedFunctionalGroupsSequence[0]
    for i, image in enumerate(pixels):
        frame = None
        if "PerFrameFunctionalGroupsSequence" in data:
            frame = data.PerFrameFunctionalGroupsSequence[i]

        def find(sequence, name, default=None):
            for group in (frame, shared):
                if group is not None and sequence in group and name in getattr(group, sequence)[0]:
                    return getattr(getattr(group, sequence)[0], name)
            return data.get(name, default)

        slope = float(find("PixelValueTransformationSequence", "RescaleSlope", 1) or 1)
        intercept = find("PixelValueTransformationSequence", "RescaleIntercept", 0)
        intercept = float(intercept or 0)
        if "DoseGridScaling" in data:
            slope, intercept = float(data.DoseGridScaling), 0.0
        default = (1, 0, 0, 0, 1, 0)
        orientation = find("PlaneOrientationSequence", "ImageOrientationPatient", default)
        orientation = np.array(orientation, float)
        position = np.array(find("PlanePositionSequence", "ImagePositionPatient"), float)
        axes = (orientation[:3], orientation[3:])
        if "GridFrameOffsetVector" in data:
            offset = float(data.GridFrameOffsetVector[i]) - float(data.GridFrameOffsetVector[0])
            position = position + np.cross(*axes) * offset
        yield {
            "samples": image.astype(np.float64) * slope + intercept,
            "axes": axes,
            "position": position,
            "spacing": np.array(find("PixelMeasuresSequence", "PixelSpacing", (1, 1)), float),
        }


def vtk_grid(path, array=None, **_):
    """Reads VTK's image and rectilinear formats by VTK's own readers."""
    import vtk
    from vtk.util.numpy_support import vtk_to_numpy

    suffix = pathlib.Path(path).suffix.lower()
    readers = {
        ".vti": vtk.vtkXMLImageDataReader,
        ".pvti": vtk.vtkXMLPImageDataReader,
        ".vtr": vtk.vtkXMLRectilinearGridReader,
        ".vtk": vtk.vtkStructuredPointsReader,
    }
    reader = readers[suffix]()
    reader.SetFileName(str(path))
    if suffix == ".vtk":
        reader.ReadAllFieldsOn()
        reader.ReadAllScalarsOn()
    reader.Update()
    grid = reader.GetOutput()
    size = np.array(grid.GetDimensions())
    points, cells = grid.GetPointData(), grid.GetCellData()
    has_points = points.GetNumberOfArrays() > 0
    data = points if has_points else cells
    values = data.GetArray(array) if array else (data.GetScalars() or data.GetArray(0))
    if isinstance(grid, vtk.vtkRectilinearGrid):
        coordinates = (grid.GetXCoordinates(), grid.GetYCoordinates(), grid.GetZCoordinates())
        axes = [vtk_to_numpy(c).astype(float) for c in coordinates]
        affine = matrix([(a[-1] - a[0]) / (len(a) - 1) for a in axes], [a[0] for a in axes])
    else:
        extent = grid.GetExtent()
        element = grid.GetDirectionMatrix().GetElement
        direction = np.array([[element(r, c) for c in range(3)] for r in range(3)])
        affine = matrix(grid.GetSpacing(), grid.GetOrigin(), direction)
        affine[:3, 3] += affine[:3, :3] @ np.array([extent[0], extent[2], extent[4]])
    if not has_points:
        size = size - 1
        affine[:3, 3] += affine[:3, :3] @ np.full(3, 0.5)
    return vtk_to_numpy(values).reshape(size, order="F"), affine


def npy(path, **_):
    return np.load(path).transpose(2, 1, 0), matrix()


def mrc(path, **_):
    import mrcfile

    with mrcfile.open(path, permissive=True) as file:
        size = file.voxel_size
        return file.data.transpose(2, 1, 0), matrix((float(size.x), float(size.y), float(size.z)))


def read(path, **choice):
    path = pathlib.Path(path)
    name = path.name.lower()
    if path.is_dir():
        has_images = any(p.suffix in (".tif", ".png") for p in path.iterdir())
        return (image_slices if has_images else dicom)(path, **choice)
    readers = {
        (".nii", ".nii.gz"): nifti,
        (".mgz", ".mgh"): mgh,
        (".nrrd", ".nhdr"): nrrd,
        (".mha", ".mhd"): meta_image,
        (".tif", ".tiff"): tiff,
        (".dcm",): dicom,
        (".vtk", ".vti", ".vtr", ".pvti"): vtk_grid,
        (".npy",): npy,
        (".mrc",): mrc,
    }
    for endings, reader in readers.items():
        if name.endswith(endings):
            return reader(path, **choice)
    raise ValueError(f"no independent reader for {path}")
