#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the compressed DICOM files of this folder.

They hold one enhanced CT of three frames, 12 bits stored of 16, in every compression that isoatlas
reads. `plain.dcm` is the same image without compression. Requires pydicom, numpy, gdcmconv
(libgdcm-tools) and dcmtk.
"""
import pathlib
import subprocess
import sys

import numpy as np
import pydicom
from pydicom.dataset import Dataset, FileMetaDataset
from pydicom.encaps import encapsulate, generate_pixel_data

HERE = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent)


def sequence(**attributes):
    item = Dataset()
    for name, value in attributes.items():
        setattr(item, name, value)
    return [item]


def image():
    y, x = np.mgrid[0:20, 0:24]
    frames = [1800 + 1700 * np.sin(x / 5 + z) * np.cos(y / 4) for z in range(3)]
    frames = np.stack(frames).astype("<u2")
    d = Dataset()
    d.file_meta = FileMetaDataset()
    d.file_meta.MediaStorageSOPClassUID = d.SOPClassUID = "1.2.840.10008.5.1.4.1.1.2.1"
    d.file_meta.MediaStorageSOPInstanceUID = d.SOPInstanceUID = "1.2.826.0.1.3680043.2.1125.8.1"
    d.file_meta.TransferSyntaxUID = "1.2.840.10008.1.2.1"
    d.is_little_endian, d.is_implicit_VR = True, False
    d.Modality = "CT"
    d.StudyInstanceUID = "1.2.826.0.1.3680043.2.1125.8"
    d.SeriesInstanceUID = "1.2.826.0.1.3680043.2.1125.8.2"
    d.PatientName, d.PatientID, d.InstanceNumber = "", "", "1"
    d.SamplesPerPixel, d.PhotometricInterpretation, d.NumberOfFrames = 1, "MONOCHROME2", 3
    d.Rows, d.Columns = 20, 24
    d.BitsAllocated, d.BitsStored, d.HighBit, d.PixelRepresentation = 16, 12, 11, 0
    rescale = sequence(RescaleSlope="1", RescaleIntercept="-1024", RescaleType="HU")
    shared = sequence(PlaneOrientationSequence=sequence(ImageOrientationPatient=[1, 0, 0, 0, 1, 0]),
                      PixelMeasuresSequence=sequence(PixelSpacing=["0.75", "0.5"]),
                      PixelValueTransformationSequence=rescale)
    d.SharedFunctionalGroupsSequence = shared
    positions = [sequence(ImagePositionPatient=[0, 0, 2 * z]) for z in range(3)]
    d.PerFrameFunctionalGroupsSequence = [
        sequence(PlanePositionSequence=position)[0] for position in positions]
    d.PixelData = frames.tobytes()
    return d


def run(*command):
    subprocess.run([str(part) for part in command], check=True, capture_output=True)


def fragmented(source, target, with_offsets):
    """Writes each frame in fragments of 200 bytes, with or without a basic offset table."""
    d = pydicom.dcmread(source)
    frames = [b"".join(fragments) for fragments in generate_pixel_data(d.PixelData)]
    data, offsets = b"", []
    for frame in frames:
        offsets.append(len(data))
        for start in range(0, len(frame), 200):
            piece = frame[start:start + 200]
            piece += b"\0" * (len(piece) % 2)
            data += b"\xFE\xFF\x00\xE0" + len(piece).to_bytes(4, "little") + piece
    table = b"".join(offset.to_bytes(4, "little") for offset in offsets) if with_offsets else b""
    d.PixelData = b"\xFE\xFF\x00\xE0" + len(table).to_bytes(4, "little") + table + data
    d["PixelData"].is_undefined_length = True
    d.save_as(target)


def main():
    plain = HERE / "plain.dcm"
    image().save_as(plain, write_like_original=False)
    run("gdcmconv", "--j2k", plain, HERE / "jpeg_2000_lossless.dcm")
    run("gdcmconv", "--jpegls", plain, HERE / "jpeg_ls_gdcm.dcm")
    run("gdcmconv", "--rle", plain, HERE / "rle.dcm")
    run("dcmcjpeg", "+e1", plain, HERE / "jpeg_lossless.dcm")
    run("dcmcjpeg", "+el", "+sv", 4, plain, HERE / "jpeg_lossless_14.dcm")
    run("dcmcjpls", plain, HERE / "jpeg_ls.dcm")
    run("dcmcjpeg", "+ee", "+q", 98, plain, HERE / "jpeg_extended_lossy.dcm")
    fragmented(HERE / "jpeg_lossless.dcm", HERE / "fragments_with_offsets.dcm", True)
    fragmented(HERE / "jpeg_lossless.dcm", HERE / "fragments_without_offsets.dcm", False)


main()
