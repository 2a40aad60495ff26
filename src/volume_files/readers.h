// SPDX-License-Identifier: Apache-2.0
// The readers of read_volume_file(), which selects one by the file's content.
#pragma once

#include <filesystem>

#include "isoatlas/volume_file.h"

namespace isoatlas::detail::io {

// Each reads one file that exists, can be read and is not empty. It
// - fills `source.format`, `source.reader`, `source.decisions` and `source.warnings`, and sets
//   `source.has_spacing`;
// - selects an entry of every list in the file by take_choice();
// - sets `volume.grid.unit` if the file states one;
// - allocates samples with allocate_samples() only after checking that the file can hold them;
// - ignores `options.spacing`, which read_volume_file() applies.
VolumeFile read_nrrd(const std::filesystem::path& path, const ReadOptions& options);
VolumeFile read_nifti(const std::filesystem::path& path, const ReadOptions& options);
VolumeFile read_mgh(const std::filesystem::path& path, const ReadOptions& options);
VolumeFile read_mrc(const std::filesystem::path& path, const ReadOptions& options);
VolumeFile read_npy(const std::filesystem::path& path, const ReadOptions& options);
VolumeFile read_meta_image(const std::filesystem::path& path, const ReadOptions& options);
VolumeFile read_tiff(const std::filesystem::path& path, const ReadOptions& options);
VolumeFile read_legacy_vtk(const std::filesystem::path& path, const ReadOptions& options);
VolumeFile read_vtk_xml(const std::filesystem::path& path, const ReadOptions& options);
VolumeFile read_dicom(const std::filesystem::path& folder, const ReadOptions& options);
VolumeFile read_image_stack(const std::filesystem::path& folder, const ReadOptions& options);
VolumeFile read_raw(const std::filesystem::path& path, const ReadOptions& options);
// These read no more than the region of the options; without samples, VolumeView::samples is null.
VolumeFile read_zarr(const std::filesystem::path& folder, const ReadOptions& options,
                     bool with_samples);
VolumeFile read_hdf5(const std::filesystem::path& path, const ReadOptions& options,
                     bool with_samples);

/// Whether a file has the mark of HDF5, and is not one of VTK's (.vtkhdf).
bool is_hdf5(const std::filesystem::path& path);

}  // namespace isoatlas::detail::io
