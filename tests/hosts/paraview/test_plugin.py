# SPDX-License-Identifier: Apache-2.0
"""The ParaView plugin in ParaView's own Python: pvbatch test_plugin.py [PICTURE].

The status of pvbatch also shows whether its process ends without a crash. PICTURE is written;
default: a temporary file.
"""

import inspect
import os
import pathlib
import re
import sys
import tempfile
import unittest

import numpy as np
from paraview import simple
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData

ROOT = pathlib.Path(__file__).resolve().parents[3]
PLUGIN = ROOT / "python/isoatlas/paraview_plugin.py"
PICTURE = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else None
if not hasattr(inspect, "getargspec"):  # ParaView 5.11.0 needs it, Python 3.11 has removed it
    inspect.getargspec = inspect.getfullargspec
simple.LoadPlugin(str(PLUGIN), remote=False, ns=globals())  # adds Isoatlas


def ball(radius=6.0):
    """Positive inside a ball; a wrong array beside the right one; turned axes."""
    nx, ny, nz = 21, 20, 18
    z, y, x = np.indices((nz, ny, nx), dtype=float)
    field = radius - np.sqrt((x - 10.2) ** 2 + (y - 9.1) ** 2 + (z - 8.3) ** 2)
    image = vtkImageData()
    image.SetExtent(5, 5 + nx - 1, -3, -3 + ny - 1, 2, 2 + nz - 1)
    image.SetSpacing(0.5, 0.7, 1.1)
    image.SetOrigin(100, -20, 3)
    c, s = np.cos(0.4), np.sin(0.4)
    image.SetDirectionMatrix(c, -s, 0, s, c, 0, 0, 0, 1)
    for name, values in (("field", field), ("negative", -field)):
        array = numpy_to_vtk(values.ravel(), deep=True)
        array.SetName(name)
        image.GetPointData().AddArray(array)
    image.GetPointData().SetActiveScalars("field")
    return image


def producer(image):
    source = simple.TrivialProducer()
    source.GetClientSideObject().SetOutput(image)
    source.UpdatePipeline()
    return source


def filter_of(source, array="field", **properties):
    made = Isoatlas(Input=source, Scalars=["POINTS", array])
    for name, value in properties.items():
        setattr(made, name, value)
    return made


def blocks(made):
    """The polygonal data of each level, and their names."""
    made.UpdatePipeline()
    output = made.GetClientSideObject().GetOutputDataObject(0)
    count = output.GetNumberOfPartitionedDataSets()
    names = [output.GetMetaData(k).Get(output.NAME()) for k in range(count)]
    return [output.GetPartition(k, 0) for k in range(count)], names


def arrays(block):
    points = vtk_to_numpy(block.GetPoints().GetData())
    faces = vtk_to_numpy(block.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    return points, faces


def index_of(image, point):
    index = [0.0, 0.0, 0.0]
    image.TransformPhysicalPointToContinuousIndex(point, index)
    return index


def enclosed(points, faces):
    a, b, c = (points[faces[:, k]] for k in range(3))
    return np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6


class Plugin(unittest.TestCase):
    def tearDown(self):
        for name in list(simple.GetSources()):
            simple.Delete(simple.GetSources()[name])

    def test_mesh_lies_in_the_image(self):
        made = filter_of(producer(ball()), Isovalue=0.0)
        ((block,), names) = blocks(made)
        self.assertEqual(names, ["level 1"])
        points, faces = arrays(block)
        middle = [0.0, 0.0, 0.0]
        ball().TransformContinuousIndexToPhysicalPoint(15.2, 6.1, 10.3, middle)
        np.testing.assert_allclose(points.mean(axis=0), middle, atol=0.3)
        volume = 4 / 3 * np.pi * 216 * 0.5 * 0.7 * 1.1
        self.assertAlmostEqual(enclosed(points, faces) / volume, 1, delta=0.1)

    def test_is_the_mesh_of_the_module(self):
        import isoatlas

        image = ball()
        made = filter_of(producer(image), Isovalue=0.5, MaxDistance=0.25, MaxVertices=400)
        ((block,), _) = blocks(made)
        origin = [0.0, 0.0, 0.0]
        image.TransformIndexToPhysicalPoint(5, -3, 2, origin)
        direction = [[image.GetDirectionMatrix().GetElement(i, j) for j in range(3)]
                     for i in range(3)]
        field = vtk_to_numpy(image.GetPointData().GetScalars()).reshape(18, 20, 21)
        volume = isoatlas.Volume(field, image.GetSpacing(), tuple(origin), direction)
        theirs = isoatlas.extract(volume, 0.5, max_distance="0.25vx", max_vertices=400)
        points, faces = arrays(block)
        np.testing.assert_array_equal(points, theirs.vertices)
        np.testing.assert_array_equal(faces, theirs.faces)

    def test_levels_are_blocks(self):
        made = filter_of(producer(ball()), Isovalue=0.0, CoarserLevels=[2.0, 1.0])
        ((finest,), names) = blocks(made)
        self.assertEqual(names, ["level 3"])
        made.OutputLevels = "All levels"
        found, names = blocks(made)
        self.assertEqual(names, ["level 0", "level 1", "level 2", "level 3"])
        sizes = [block.GetNumberOfPolys() for block in found]
        self.assertEqual(sizes, sorted(sizes))
        self.assertEqual(sizes[-1], finest.GetNumberOfPolys())
        distance = vtk_to_numpy(found[-1].GetPointData().GetArray("max_distance"))
        self.assertLessEqual(distance.max(), 0.25)  # half of the smallest spacing
        for block in found:
            self.assertEqual(block.GetFieldData().GetArray("genus").GetValue(0), 0)
        made.CoarserLevels = []
        self.assertEqual(len(blocks(made)[0]), 2)

    def test_number_of_levels(self):
        made = filter_of(producer(ball()), Isovalue=0.0, MaxDistance=0.2, Levels=3)
        made.OutputLevels = "All levels"
        found, names = blocks(made)
        self.assertEqual(names, ["level 0", "level 1", "level 2"])
        for k, block in enumerate(found):
            distance = vtk_to_numpy(block.GetPointData().GetArray("max_distance"))
            self.assertLessEqual(distance.max(), 0.5 * 0.8 / 2**k + 1e-6)
        made.CoarserLevels = [1.0]
        self.assertEqual(blocks(made)[0], [])  # refused: Levels chooses all levels
        made.CoarserLevels = []
        self.assertEqual(len(blocks(made)[0]), 3)

    def test_caps(self):
        image = ball()
        made = filter_of(producer(image), Isovalue=-4.0)  # a ball of radius 10 leaves the volume
        ((block,), _) = blocks(made)
        self.assertGreater(block.GetFieldData().GetArray("boundary_loops").GetValue(0), 0)
        self.assertIsNone(block.GetCellData().GetArray("cap"))
        made.Border = "Closed by caps"
        ((block,), _) = blocks(made)
        self.assertEqual(block.GetFieldData().GetArray("boundary_loops").GetValue(0), 0)
        points, faces = arrays(block)
        caps = vtk_to_numpy(block.GetCellData().GetArray("cap"))
        self.assertTrue(0 < caps.sum() < len(faces) and set(caps) == {0, 1})
        index = np.array([index_of(image, point) for point in points])
        sides = np.array(image.GetExtent(), float).reshape(3, 2)
        on_side = np.isclose(index[:, :, None], sides, rtol=0, atol=1e-9)
        is_planar = on_side[faces].all(axis=1).any(axis=(1, 2))
        np.testing.assert_array_equal(is_planar, caps == 1)

    def test_array_and_side_are_chosen(self):
        source = producer(ball())
        for array, side, sign in (
            ("field", "Above the isovalue", 1), ("negative", "Above the isovalue", -1),
            ("negative", "Below the isovalue", 1), ("field", "Below the isovalue", -1),
        ):
            ((block,), _) = blocks(filter_of(source, array, Isovalue=0.1, Inside=side))
            self.assertGreater(sign * enclosed(*arrays(block)), 0, (array, side))

    def test_isovalue_starts_in_the_middle_of_the_range(self):
        made = Isoatlas(Input=producer(ball()))
        low, high = ball().GetPointData().GetScalars().GetRange()
        self.assertAlmostEqual(made.Isovalue, (low + high) / 2, places=5)

    def test_coarse(self):
        ((fine,), _) = blocks(filter_of(producer(ball()), Isovalue=0.0))
        ((coarse,), names) = blocks(filter_of(producer(ball()), Isovalue=0.0, CoarseOnly=1))
        self.assertEqual(names, ["level 0"])
        self.assertLess(coarse.GetNumberOfPolys(), fine.GetNumberOfPolys())

    def test_progress_and_abort(self):
        for abort in (False, True):
            made = filter_of(producer(ball()), Isovalue=0.0, MaxDistance=0.05)
            algorithm = made.GetClientSideObject()
            fractions, stages = [], []

            def on_progress(caller, _event):
                fractions.append(caller.GetProgress())
                stages.append(caller.GetProgressText())
                if abort and caller.GetProgress() > 0.2:
                    caller.SetAbortExecute(1)

            algorithm.AddObserver("ProgressEvent", on_progress)
            found, _ = blocks(made)
            self.assertEqual(fractions, sorted(fractions))
            self.assertIn("cover", stages)
            self.assertEqual(len(found), 0 if abort else 1)
            algorithm.RemoveAllObservers()

    def test_errors_empty_the_output(self):
        found, _ = blocks(filter_of(producer(ball()), Isovalue=1000.0))
        self.assertEqual(found, [])

    def test_script_on_the_page(self):
        (code,) = re.findall(r"(?ms)^```python\n(.*?)^```$",
                             (ROOT / "docs/hosts/paraview.md").read_text())
        before = os.getcwd()
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            try:
                os.symlink(ROOT / "samples", "samples")
                exec(compile(code, "paraview.md", "exec"), {})
                self.assertEqual(len(list(pathlib.Path("protein").glob("*.vtp"))), 4)
            finally:
                os.chdir(before)

    def test_picture_of_a_protein(self):
        reader = simple.OpenDataFile(str(ROOT / "samples/protein_iron.nhdr"))
        made = Isoatlas(Input=reader)
        made.Isovalue = 100.5
        view = simple.CreateView("RenderView")
        view.ViewSize = [1200, 700]
        view.OrientationAxesVisibility = 0
        volume = simple.Show(reader, view)
        volume.SetRepresentationType("Outline")
        shown = simple.Show(made, view)
        shown.SetRepresentationType("Surface With Edges")
        simple.ColorBy(shown, ("POINTS", "max_distance"))
        shown.SetScalarBarVisibility(view, True)
        simple.ResetCamera(view)
        camera = simple.GetActiveCamera()
        camera.Elevation(20)
        camera.Azimuth(35)
        simple.ResetCamera(view)
        camera.Zoom(1.6)
        with tempfile.TemporaryDirectory() as folder:
            path = PICTURE or pathlib.Path(folder) / "picture.png"
            simple.SaveScreenshot(str(path), view, ImageResolution=[1200, 700])
            pixels = self.pixels(path)
        self.assertGreater(len(np.unique(pixels.reshape(-1, 3), axis=0)), 200)
        background = (pixels == pixels[0, 0]).all(axis=2).mean()
        self.assertTrue(0.3 < background < 0.97, background)

    @staticmethod
    def pixels(path):
        from vtkmodules.vtkIOImage import vtkPNGReader

        reader = vtkPNGReader()
        reader.SetFileName(str(path))
        reader.Update()
        image = reader.GetOutput()
        scalars = vtk_to_numpy(image.GetPointData().GetScalars())
        return scalars.reshape(*image.GetDimensions()[1::-1], -1)[..., :3]


if __name__ == "__main__":
    suite = unittest.defaultTestLoader.loadTestsFromTestCase(Plugin)
    result = unittest.TextTestRunner(verbosity=2, stream=sys.stdout).run(suite)
    if not result.wasSuccessful():
        sys.exit(1)
