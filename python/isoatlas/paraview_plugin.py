# SPDX-License-Identifier: Apache-2.0
"""A ParaView plugin in one file: the filter Isoatlas meshes an isosurface of an image.

Load it in ParaView with Tools > Manage Plugins > Load New, or in a script::

    from paraview.simple import LoadPlugin
    LoadPlugin(path, remote=False, ns=globals())

where ``path`` is the path of this file. It is plain Python and needs no build against ParaView, but
ParaView's Python must find the module isoatlas. See docs/hosts/paraview.md.
"""

from __future__ import annotations

import sys

import numpy as np
from paraview import print_error, print_warning
from paraview.util.vtkAlgorithm import VTKPythonAlgorithmBase, smdomain, smproperty, smproxy
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkDoubleArray
from vtkmodules.vtkCommonDataModel import (
    vtkCompositeDataSet,
    vtkDataObject,
    vtkDataSetAttributes,
    vtkImageData,
    vtkPartitionedDataSet,
    vtkPartitionedDataSetCollection,
)
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline

# The choices of the panel and the values of the options that they stand for.
SIDES = {"Above the isovalue": "above", "Below the isovalue": "below"}
NAN = {"Refuse": None, "Below the isovalue": "below", "Above the isovalue": "above"}
PLACEMENTS = {"On the isosurface": "surface", "Balanced": "balanced"}
BORDERS = {"Open": "open", "Closed by caps": "closed"}
OUTPUTS = {"Finest level": False, "All levels": True}
MOST_LEVELS = 16


def _import_isoatlas():
    """The module isoatlas, imported when the filter runs: ParaView loads the plugin without it."""
    try:
        import isoatlas
    except ImportError as error:
        version = ".".join(map(str, sys.version_info[:2]))
        raise ImportError(
            f"the filter needs the module isoatlas for ParaView's Python {version} ({error}); "
            "install it and put its folder on PYTHONPATH before ParaView starts"
        ) from error
    return isoatlas


class _Aborted(Exception):
    """The user pressed Cancel."""


def _volume(image, samples):
    """The image as a Volume of isoatlas. VTK allows a negative spacing: an axis runs backwards."""
    if samples is None:
        raise ValueError("the image has no point array to mesh: choose one with Scalars")
    name = samples.GetName()
    if samples.GetNumberOfComponents() != 1:
        raise ValueError(f"{name}: it has {samples.GetNumberOfComponents()} components, expected 1")
    if samples.GetNumberOfTuples() != image.GetNumberOfPoints():
        raise ValueError(f"{name}: it is no array of the points; convert cell data to point data")
    extent = image.GetExtent()
    origin = [0.0, 0.0, 0.0]
    image.TransformIndexToPhysicalPoint(extent[0], extent[2], extent[4], origin)
    matrix = image.GetDirectionMatrix()
    spacing = np.asarray(image.GetSpacing())
    direction = np.array([[matrix.GetElement(i, j) for j in range(3)] for i in range(3)])
    return _import_isoatlas().Volume(
        vtk_to_numpy(samples).reshape(image.GetDimensions()[::-1]),
        tuple(np.abs(spacing)),
        tuple(origin),
        (direction * np.where(spacing < 0, -1, 1)).tolist(),
    )


def _number(name, value):
    array = vtkDoubleArray()
    array.SetName(name)
    array.InsertNextValue(value)
    return array


def _block(mesh, number):
    """A level as vtkPolyData, with its topology in the field data."""
    block = mesh.to_vtk(number)
    report = mesh.levels[number].report
    for name in ("components", "genus", "boundary_loops", "distance_at_most"):
        if report.get(name) is not None:
            block.GetFieldData().AddArray(_number(name, report[name]))
    return block


def _fill(output, mesh, levels):
    output.SetNumberOfPartitionedDataSets(len(levels))
    for index, number in enumerate(levels):
        pieces = vtkPartitionedDataSet()
        pieces.SetNumberOfPartitions(1)
        pieces.SetPartition(0, _block(mesh, number))
        output.SetPartitionedDataSet(index, pieces)
        output.GetMetaData(index).Set(vtkCompositeDataSet.NAME(), f"level {number}")


def _property(kind, name, label, default, domain="", text="", advanced=False, hints=""):
    """XML of a property with one value, which the method ``Set`` + name receives."""
    visibility = "advanced" if advanced else "default"
    return f"""
<{kind}VectorProperty name="{name}" label="{label}" command="Set{name}" number_of_elements="1"
    default_values="{default}" panel_visibility="{visibility}">
  {domain}<Documentation>{text}</Documentation>{hints}
</{kind}VectorProperty>"""


def _choice(name, label, choices, text, advanced=False):
    entries = "".join(
        f'<Entry value="{index}" text="{entry}"/>' for index, entry in enumerate(choices)
    )
    domain = f'<EnumerationDomain name="enum">{entries}</EnumerationDomain>'
    return _property("Int", name, label, 0, domain, text, advanced)


def _switch(name, label, text, hints=""):
    domain = '<BooleanDomain name="bool"/>'
    return _property("Int", name, label, 0, domain, text, advanced=True, hints=hints)


# A property that a number of levels makes useless is greyed out.
WITHOUT_LEVELS = """<Hints>
  <PropertyWidgetDecorator type="GenericDecorator" mode="enabled_state" property="Levels"
      value="0"/>
</Hints>"""

# The panel has the properties in this order. Scripts name a property by its label without blanks.
PROPERTIES = "".join((
    """
<StringVectorProperty name="SelectInputScalars" label="Scalars"
    command="SetInputArrayToProcess" number_of_elements="5" element_types="0 0 0 0 2"
    animateable="0">
  <ArrayListDomain name="array_list" attribute_type="Scalars" input_domain_name="inputs_array">
    <RequiredProperties><Property name="Input" function="Input"/></RequiredProperties>
  </ArrayListDomain>
  <Documentation>The point array to mesh.</Documentation>
</StringVectorProperty>""",
    _property(
        "Double", "Isovalue", "Isovalue", 0,
        """<ArrayRangeDomain name="range" default_mode="mid">
  <RequiredProperties>
    <Property name="Input" function="Input"/>
    <Property name="SelectInputScalars" function="ArraySelection"/>
  </RequiredProperties>
</ArrayRangeDomain>""",
        "The value on the surface. For integer samples use a value between two integers.",
    ),
    _choice("Inside", "Inside", SIDES, "The side that is inside the surface."),
    _property(
        "Double", "MaxDistance", "Max Distance", 0.5,
        '<DoubleRangeDomain name="range" min="0.01" max="10"/>',
        "Upper bound of the two-sided distance between surface and mesh, in voxels (the smallest "
        "spacing).",
    ),
    _property(
        "Int", "MaxVertices", "Max Vertices", 0,
        text="Largest number of vertices, which has priority over the distance. 0: no limit.",
    ),
    _property(
        "Int", "KeepComponents", "Keep Components", 0,
        text="Keep only this number of largest components. 0: all.",
    ),
    _choice(
        "Border", "Border", BORDERS,
        "The mesh where the volume boundary cuts the surface: it ends there, or planar caps close "
        "it. The cell array cap marks them.",
    ),
    _property(
        "Int", "Levels", "Levels", 0, f'<IntRangeDomain name="range" min="0" max="{MOST_LEVELS}"/>',
        "Number of levels whose bounds are chosen: each has half the bound of the previous one, or "
        "more, and the finest has Max Distance. 0: only the levels of Coarser Levels.",
    ),
    f"""
<DoubleVectorProperty name="CoarserLevels" label="Coarser Levels" command="AddCoarserLevel"
    clean_command="RemoveCoarserLevels" repeat_command="1" number_of_elements_per_command="1"
    use_index="0">
  <Documentation>
    Bounds of the distance of additional levels, in voxels, largest first.
  </Documentation>{WITHOUT_LEVELS}
</DoubleVectorProperty>""",
    _choice(
        "OutputLevels", "Output Levels", OUTPUTS,
        "All levels are shown on top of each other; hide blocks with the Multiblock Inspector.",
    ),
    _switch(
        "CoarseOnly", "Coarse Only", "Only the coarsest mesh that preserves the topology.",
        WITHOUT_LEVELS,
    ),
    _choice(
        "NaNSamples", "NaN Samples", NAN, "The side of the isovalue on which NaN samples are.",
        advanced=True,
    ),
    _choice(
        "Placement", "Placement", PLACEMENTS,
        "Balanced: vertices are displaced so that the mesh lies evenly on both sides.",
        advanced=True,
    ),
    _switch(
        "AllowSelfIntersections", "Allow Self Intersections",
        "Keep triangles that intersect: faster, and fewer triangles.",
    ),
))


@smproxy.filter(name="Isoatlas", label="Isoatlas")
@smproperty.xml(PROPERTIES)
@smproperty.input(name="Input", port_index=0)
@smdomain.datatype(dataTypes=["vtkImageData"], composite_data_supported=False)
class Isoatlas(VTKPythonAlgorithmBase):
    """Mesh an isosurface of an image, with certified topology and a bound of the error.

    The output is a partitioned data set collection with one block per level of detail.
    """

    def __init__(self):
        super().__init__(
            nInputPorts=1, nOutputPorts=1, outputType="vtkPartitionedDataSetCollection"
        )
        self.SetInputArrayToProcess(
            0, 0, 0, vtkDataObject.FIELD_ASSOCIATION_POINTS, vtkDataSetAttributes.SCALARS
        )
        self._isovalue = 0.0
        self._options = {"max_distance": "0.5vx"}
        self._coarser = []
        self._all_levels = False

    def _set(self, name, value):
        if self._options.get(name) != value:
            self._options[name] = value
            self.Modified()

    def _choose(self, name, choices, index):
        self._set(name, list(choices.values())[index])

    def SetIsovalue(self, value):
        if value != self._isovalue:
            self._isovalue = value
            self.Modified()

    def SetInside(self, side):
        self._choose("inside", SIDES, side)

    def SetMaxDistance(self, voxels):
        self._set("max_distance", f"{voxels!r}vx" if voxels > 0 else None)

    def SetMaxVertices(self, count):
        self._set("max_vertices", count or None)

    def SetKeepComponents(self, count):
        self._set("keep_components", count or None)

    def SetBorder(self, choice):
        self._choose("border", BORDERS, choice)

    def SetLevels(self, count):
        self._set("levels", count or None)

    def AddCoarserLevel(self, voxels):
        self._coarser.append(voxels)
        self.Modified()

    def RemoveCoarserLevels(self):
        if self._coarser:
            self._coarser = []
            self.Modified()

    def SetOutputLevels(self, choice):
        if bool(choice) != self._all_levels:
            self._all_levels = bool(choice)
            self.Modified()

    def SetCoarseOnly(self, flag):
        self._set("coarse", bool(flag))

    def SetNaNSamples(self, side):
        self._choose("nan", NAN, side)

    def SetPlacement(self, choice):
        self._choose("placement", PLACEMENTS, choice)

    def SetAllowSelfIntersections(self, flag):
        self._set("allow_self_intersections", bool(flag))

    def FillInputPortInformation(self, port, info):
        info.Set(self.INPUT_REQUIRED_DATA_TYPE(), "vtkImageData")
        return 1

    def RequestUpdateExtent(self, request, inputs, outputs):
        info = inputs[0].GetInformationObject(0)
        whole = info.Get(vtkStreamingDemandDrivenPipeline.WHOLE_EXTENT())
        info.Set(vtkStreamingDemandDrivenPipeline.UPDATE_EXTENT(), whole, 6)
        return 1

    def _report_progress(self, stage, fraction):
        self.SetProgressText(stage)
        self.UpdateProgress(fraction)
        if self.GetAbortExecute():
            raise _Aborted

    def _samples(self, image):
        """The chosen array; by default the active scalars."""
        name = self.GetInputArrayInformation(0).Get(vtkDataObject.FIELD_NAME())
        points = image.GetPointData()
        return points.GetArray(name) if name else points.GetScalars()

    def _mesh(self, image, samples):
        options = {name: value for name, value in self._options.items() if value is not None}
        if options.get("levels") and (options.get("coarse") or self._coarser):
            other = "Coarse Only" if options.get("coarse") else "Coarser Levels"
            raise ValueError(f"Levels chooses all levels, expected it without {other}")
        if options.get("coarse"):
            options.pop("max_distance", None)  # the coarse mesh is not refined
        elif self._coarser:
            bounds = [f"{voxels!r}vx" for voxels in self._coarser]
            bounds.append(options.pop("max_distance", "0.5vx"))
            options["refine"] = [{"max_distance": bound} for bound in bounds]
        return _import_isoatlas().extract(
            _volume(image, samples), self._isovalue, progress=self._report_progress, **options
        )

    def RequestData(self, request, inputs, outputs):
        output = vtkPartitionedDataSetCollection.GetData(outputs, 0)
        output.Initialize()
        piece = outputs.GetInformationObject(0).Get(
            vtkStreamingDemandDrivenPipeline.UPDATE_PIECE_NUMBER()
        )
        if piece:  # the first process of a parallel server has the whole mesh
            return 1
        image = vtkImageData.GetData(inputs[0], 0)
        try:
            mesh = self._mesh(image, self._samples(image))
        except _Aborted:
            return 1
        except (ValueError, OSError, MemoryError, ImportError, RuntimeError) as error:
            print_error(f"Isoatlas: {error}")
            return 1  # ParaView would add a dump of the request to the line
        for line in mesh.unmet:
            print_warning(f"Isoatlas: {line}")
        finest = len(mesh.levels) - 1
        _fill(output, mesh, range(finest + 1) if self._all_levels else [finest])
        return 1
