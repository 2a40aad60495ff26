#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws the marching-cubes mesh of a volume and isoatlas' mesh side by side, with edges, as a PNG.

    xvfb-run -a /usr/bin/python3 bench/picture.py VOLUME.nhdr ISOVALUE MESH.ply OUT.png \\
        [AZIMUTH ELEVATION]

MESH must be written with --space voxel. Needs Debian's python3-vtk9 and, without a display, xvfb.
"""

import gzip
import pathlib
import sys

import numpy
import vtk
from vtk.util import numpy_support


def actor(port, colour):
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputConnection(port)
    mapper.ScalarVisibilityOff()
    out = vtk.vtkActor()
    out.SetMapper(mapper)
    p = out.GetProperty()
    p.SetColor(*colour)
    p.SetInterpolationToFlat()
    p.SetAmbient(0.35)
    p.SetDiffuse(0.65)
    p.EdgeVisibilityOn()
    p.SetEdgeColor(0.15, 0.17, 0.2)
    return out


def read_nrrd(path):
    """Read a raw or gzipped NRRD with one scalar per sample, in sample-index coordinates.

    The reader of VTK 9.1 does not handle gzip and detached headers well.
    """
    path = pathlib.Path(path)
    head, _, body = path.read_bytes().partition(b"\n\n")
    fields = dict(
        line.split(": ", 1)
        for line in head.decode().splitlines()
        if ": " in line and not line.startswith("#")
    )
    if "data file" in fields:
        body = (path.parent / fields["data file"]).read_bytes()
    if fields["encoding"] in ("gzip", "gz"):
        body = gzip.decompress(body)
    types = {
        "uint8": numpy.uint8,
        "unsigned char": numpy.uint8,
        "int16": numpy.int16,
        "short": numpy.int16,
        "float": numpy.float32,
    }
    samples = numpy.frombuffer(body, types[fields["type"]])
    image = vtk.vtkImageData()
    image.SetDimensions(*map(int, fields["sizes"].split()))
    image.GetPointData().SetScalars(numpy_support.numpy_to_vtk(samples.copy(), deep=True))
    return image


def main():
    volume, iso, mesh, out = sys.argv[1], float(sys.argv[2]), sys.argv[3], sys.argv[4]
    contour = vtk.vtkMarchingCubes()
    contour.SetInputData(read_nrrd(volume))
    contour.SetValue(0, iso)
    ply = vtk.vtkPLYReader()
    ply.SetFileName(mesh)
    contour.Update()
    ply.Update()

    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetSize(1400, 700)
    window.SetMultiSamples(8)
    camera = None
    for column, (source, name, colour) in enumerate(
        ((contour, "marching cubes", (0.80, 0.82, 0.85)), (ply, "isoatlas", (0.93, 0.80, 0.60)))
    ):
        renderer = vtk.vtkRenderer()
        renderer.SetViewport(column / 2, 0, (column + 1) / 2, 1)
        renderer.SetBackground(1, 1, 1)
        renderer.AddActor(actor(source.GetOutputPort(), colour))
        if camera is None:
            renderer.ResetCamera()
            camera = renderer.GetActiveCamera()
            camera.Azimuth(float(sys.argv[5]) if len(sys.argv) > 5 else 35)
            camera.Elevation(float(sys.argv[6]) if len(sys.argv) > 6 else 25)
            camera.Zoom(1.3)
            renderer.ResetCameraClippingRange()
        else:
            renderer.SetActiveCamera(camera)
        text = vtk.vtkTextActor()
        text.SetInput(f"{name}: {source.GetOutput().GetNumberOfPolys():,} triangles")
        text.GetTextProperty().SetFontSize(24)
        text.GetTextProperty().SetColor(0.15, 0.17, 0.2)
        text.SetPosition(16, 14)
        renderer.AddViewProp(text)
        window.AddRenderer(renderer)
    window.Render()
    grab = vtk.vtkWindowToImageFilter()
    grab.SetInput(window)
    grab.ReadFrontBufferOff()
    writer = vtk.vtkPNGWriter()
    writer.SetFileName(out)
    writer.SetInputConnection(grab.GetOutputPort())
    writer.Write()


if __name__ == "__main__":
    main()
