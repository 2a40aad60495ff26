// SPDX-License-Identifier: Apache-2.0
// Based on: DICOM PS3.3, mainly C.7.6.2 (image plane), C.7.6.3 (image pixel), C.7.6.16 (functional
// groups of multi-frame images), C.8.4 (nuclear medicine), C.8.8.3 (dose grid) and C.11.1 (modality
// lookup table, rescale).
#include "volume_files/dicom_image.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <iterator>
#include <optional>
#include <string_view>
#include <utility>

#include "files/file_error.h"
#include "volume_files/dicom_codec.h"

namespace isoatlas::detail::io {

namespace fs = std::filesystem;
using namespace dicom;

namespace {

using Kind = DicomLabel::Kind;

constexpr std::string_view kDirectoryClass = "1.2.840.10008.1.3.10",
                           kNuclearClass = "1.2.840.10008.5.1.4.1.1.20",
                           kSegmentationClass = "1.2.840.10008.5.1.4.1.1.66.4",
                           kParametricMapClass = "1.2.840.10008.5.1.4.1.1.30";
constexpr DicomTag kFrameTime = 0x00181063, kFrameTimeVector = 0x00181065;

// The reason why the frames of a file are not slices of a volume. Thrown inside this file only.
struct Unusable {
  std::string why;
};

std::string joined(const std::vector<std::string>& values) {
  std::string all;
  for (const std::string& value : values) {
    all += (all.empty() ? "" : "\\") + value;
  }
  return all;
}

bool contains(const std::vector<std::string>& values, std::string_view wanted) {
  return std::ranges::any_of(
      values, [&](const std::string& value) { return value.find(wanted) != std::string::npos; });
}

std::optional<Vec3> vector_in(const std::vector<double>& numbers, std::size_t first) {
  if (numbers.size() < first + 3) {
    return std::nullopt;
  }
  return Vec3{numbers[first], numbers[first + 1], numbers[first + 2]};
}

Vec3 unit_normal(const DicomFrame& frame) {
  const Vec3 &r = frame.along_row, &c = frame.along_column;
  const Vec3 n{r.y * c.z - r.z * c.y, r.z * c.x - r.x * c.z, r.x * c.y - r.y * c.x};
  const double length = std::hypot(n.x, n.y, n.z);
  return {n.x / length, n.y / length, n.z / length};
}

Vec3 moved(const Vec3& from, const Vec3& along, double by) {
  return {from.x + by * along.x, from.y + by * along.y, from.z + by * along.z};
}

/// The attributes of one frame: those in its own functional group, else in the group shared by all
/// frames, else in the file.
class FrameAttributes {
 public:
  FrameAttributes(const DicomDataSet& file, std::size_t frame)
      : file_(file), shared_(file.first_item(kSharedGroups)) {
    const std::vector<DicomDataSet>& groups = file.items(kPerFrameGroups);
    own_ = groups.empty() ? nullptr : &groups.at(frame);
  }

  bool has_groups() const { return own_ != nullptr || shared_ != nullptr; }
  const DicomDataSet& file() const { return file_; }

  /// The first item of a functional group; null if it is missing.
  const DicomDataSet* group(DicomTag sequence) const {
    for (const DicomDataSet* groups : {own_, shared_}) {
      if (groups != nullptr && groups->first_item(sequence) != nullptr) {
        return groups->first_item(sequence);
      }
    }
    return nullptr;
  }

  /// The data set that holds `tag`: that functional group, or the file.
  const DicomDataSet& holder(DicomTag sequence, DicomTag tag) const {
    const DicomDataSet* found = group(sequence);
    return found != nullptr && found->has(tag) ? *found : file_;
  }

 private:
  const DicomDataSet& file_;
  const DicomDataSet* shared_ = nullptr;
  const DicomDataSet* own_ = nullptr;
};

/// Reads the frames of one file.
class ImageReading {
 public:
  ImageReading(const DicomContents& contents, DicomImage& image)
      : contents_(contents), file_(contents.attributes), image_(image) {}

  std::vector<DicomFrame> frames(std::uint64_t max_memory) {
    require_grey_values();
    read_format(max_memory);
    check_length();
    const std::size_t groups = file_.items(kPerFrameGroups).size();
    if (groups != 0 && groups != image_.frames) {
      throw Unusable{"has " + std::to_string(image_.frames) + " frames, but attributes of " +
                     std::to_string(groups)};
    }
    if (!image_.damage.empty() && groups == 0 && image_.frames > 1) {
      throw bad_file(image_.path, image_.damage);
    }
    std::vector<DicomFrame> all;
    if (image_.frames == 1 || groups != 0) {
      for (std::size_t i = 0; i < image_.frames; ++i) {
        all.push_back(frame_with_position(i));
      }
    } else {
      all = frames_without_positions();
    }
    for (std::size_t i = 0; i < all.size(); ++i) {
      const FrameAttributes attributes(file_, i);
      read_rescale(attributes, all[i]);
      add_labels(attributes, all[i]);
      all[i].labels = std::make_shared<const std::vector<DicomLabel>>(std::exchange(labels_, {}));
    }
    return all;
  }

 private:
  void require_grey_values() {
    const std::string colour = file_.text(kPhotometricInterpretation);
    const std::int64_t samples = file_.integer(kSamplesPerPixel).value_or(1);
    if (samples != 1 || colour.find("RGB") != std::string::npos || colour.starts_with("YBR")) {
      throw Unusable{
          "is a colour image (" +
          (colour.empty() ? std::to_string(samples) + " samples per pixel" : dicom_text(colour)) +
          ")"};
    }
    if (colour == "PALETTE COLOR") {
      throw Unusable{"is a colour image (PALETTE COLOR)"};
    }
    image_.is_inverted_display = colour == "MONOCHROME1";
    const bool is_siemens = file_.text(kPrivateCreator19).starts_with("SIEMENS");
    if (contains(file_.texts(kImageType), "MOSAIC") ||
        (is_siemens && file_.integer(kMosaicImages).value_or(0) > 1)) {
      throw Unusable{"is a mosaic: several slices are tiles of one image"};
    }
    if (image_.sop_class == kSegmentationClass) {
      throw Unusable{"is a DICOM segmentation (SEG)"};
    }
    if (file_.has(kModalityTable)) {
      throw Unusable{"has a modality lookup table, which isoatlas does not apply"};
    }
  }

  void read_format(std::uint64_t max_memory) {
    DicomSampleFormat& format = image_.format;
    if (image_.rows == 0 || image_.columns == 0) {
      throw Unusable{"states no image size (Rows, Columns)"};
    }
    constexpr std::size_t kMostRows = 0xFFFF;  // the attributes have 16 bits
    if (image_.rows > kMostRows || image_.columns > kMostRows) {
      throw Unusable{"states an image size of " + std::to_string(image_.columns) + " x " +
                     std::to_string(image_.rows) + ", expected at most 65535 x 65535"};
    }
    const auto natural = [&](DicomTag tag, unsigned otherwise) {
      return static_cast<unsigned>(
          std::clamp<std::int64_t>(file_.integer(tag).value_or(otherwise), 0, 0xFFFF));
    };
    format.bits_allocated = natural(kBitsAllocated, 0);
    format.bits_stored = natural(kBitsStored, format.bits_allocated);
    format.bits_stored = format.bits_stored == 0 ? format.bits_allocated : format.bits_stored;
    format.high_bit = natural(kHighBit, format.bits_stored - 1);
    format.is_signed = natural(kPixelRepresentation, 0) == 1;
    if (image_.pixels.tag != kPixelData) {
      const unsigned bits = image_.pixels.tag == kFloatPixelData ? 32 : 64;
      format = {bits, bits, bits - 1, true, true};
    } else if (format.bits_allocated != 8 && format.bits_allocated != 16 &&
               format.bits_allocated != 32) {
      throw Unusable{"has " + std::to_string(format.bits_allocated) +
                     " bits per sample (BitsAllocated), expected 8, 16 or 32"};
    }
    if (image_.pixels.is_compressed) {
      read_compressed_format(max_memory);
    }
    if (format.bits_stored > format.bits_allocated || format.high_bit + 1 < format.bits_stored ||
        format.high_bit >= format.bits_allocated) {
      throw Unusable{"has contradictory bits: " + std::to_string(format.bits_stored) +
                     " stored of " + std::to_string(format.bits_allocated) +
                     " allocated, high bit " + std::to_string(format.high_bit)};
    }
  }

  void read_compressed_format(std::uint64_t max_memory) {
    if (!can_decode(image_.transfer_syntax)) {
      throw Unusable{"is compressed with a method that isoatlas does not decode (transfer syntax " +
                     dicom_text(image_.transfer_syntax) + ")"};
    }
    if (image_.pixels.fragments.size() < image_.frames) {
      set_damage("is cut off: it has " + std::to_string(image_.pixels.fragments.size()) +
                 " compressed frames of " + std::to_string(image_.frames));
      return;
    }
    DicomBytes bytes = open_dicom(image_.path, max_memory);
    const std::string problem = adapt_to_stream(bytes, image_);
    if (!problem.empty()) {
      set_damage(problem);
    }
  }

  void check_length() {
    const DicomPixels& pixels = image_.pixels;
    if (contents_.is_cut_off) {
      set_damage("is cut off: its data elements extend beyond its " +
                 std::to_string(contents_.bytes) + " bytes");
    }
    if (pixels.is_compressed) {
      return;
    }
    const std::uint64_t frame_bytes =
        std::uint64_t{image_.rows} * image_.columns * (image_.format.bits_allocated / 8);
    const bool has_exact_length =
        pixels.bytes / frame_bytes == image_.frames && pixels.bytes % frame_bytes <= 1;
    if (can_decode(image_.transfer_syntax) && !has_exact_length) {
      set_damage("states that it is compressed (" + compression_name(image_.transfer_syntax) +
                 "), but its pixel data is not");
    } else if (pixels.bytes / frame_bytes < image_.frames) {
      set_damage("is cut off: its pixel data has " + std::to_string(pixels.bytes) +
                 " bytes, its header states " + std::to_string(image_.frames) + " x " +
                 std::to_string(frame_bytes));
    } else if (pixels.bytes - frame_bytes * image_.frames > 1) {
      image_.warnings.push_back("has " +
                                std::to_string(pixels.bytes - frame_bytes * image_.frames) +
                                " bytes of pixel data more than its frames need; they are ignored");
    }
  }

  void set_damage(const std::string& what) {
    if (image_.damage.empty()) {
      image_.damage = what;
    }
  }

  // Reads a frame whose position and orientation are stated.
  DicomFrame frame_with_position(std::size_t number) {
    const FrameAttributes attributes(file_, number);
    DicomFrame frame;
    frame.number = number;
    read_orientation(attributes, frame);
    std::vector<double> position =
        attributes.holder(kPlanePosition, kImagePosition).numbers(kImagePosition);
    if (position.empty()) {
      position = attributes.holder(kPlanePositionVolume, kImagePositionVolume)
                     .numbers(kImagePositionVolume);
    }
    set_position(position, frame);
    read_spacing(attributes, frame);
    return frame;
  }

  static void set_position(const std::vector<double>& position, DicomFrame& frame) {
    const std::optional<Vec3> stated_position = vector_in(position, 0);
    if (!stated_position) {
      throw Unusable{"has no position (ImagePositionPatient)"};
    }
    frame.position = *stated_position;
  }

  void read_orientation(const FrameAttributes& attributes, DicomFrame& frame) {
    std::vector<double> cosines =
        attributes.holder(kPlaneOrientation, kImageOrientation).numbers(kImageOrientation);
    if (cosines.empty()) {
      cosines = attributes.holder(kPlaneOrientationVolume, kImageOrientationVolume)
                    .numbers(kImageOrientationVolume);
      if (!cosines.empty() && image_.warnings.empty()) {
        image_.warnings.push_back("states positions in the ultrasound volume, not in the patient");
      }
    }
    set_orientation(cosines, attributes.file(), frame);
  }

  static void set_orientation(const std::vector<double>& cosines, const DicomDataSet& file,
                              DicomFrame& frame) {
    constexpr double kSmallestSine = 0.99;
    const std::optional<Vec3> row = vector_in(cosines, 0), column = vector_in(cosines, 3);
    if (!row || !column) {
      throw Unusable{file.has(kImagePosition) ? "has no orientation (ImageOrientationPatient)"
                                              : "has no position (ImagePositionPatient) and no "
                                                "orientation (ImageOrientationPatient)"};
    }
    const Vec3 &r = *row, &c = *column;
    const double area =
        std::hypot(r.y * c.z - r.z * c.y, r.z * c.x - r.x * c.z, r.x * c.y - r.y * c.x);
    if (!(area >= kSmallestSine * std::hypot(r.x, r.y, r.z) * std::hypot(c.x, c.y, c.z)) ||
        area == 0) {
      throw Unusable{
          "has an orientation (ImageOrientationPatient) whose two directions are not "
          "perpendicular"};
    }
    frame.along_row = r;
    frame.along_column = c;
  }

  void read_spacing(const FrameAttributes& attributes, DicomFrame& frame) {
    const DicomDataSet& holder = attributes.holder(kPixelMeasures, kPixelSpacing);
    DicomTag source = kPixelSpacing;
    if (!holder.has(source)) {
      source = file_.has(kImagerPixelSpacing) ? kImagerPixelSpacing : kNominalScannedPixelSpacing;
      if (!file_.has(source)) {
        warn_once("states no PixelSpacing; 1 x 1 mm is assumed within a slice");
        return;
      }
      warn_once(
          source == kImagerPixelSpacing
              ? "states no PixelSpacing; ImagerPixelSpacing, measured at the detector, is used"
              : "states no PixelSpacing; NominalScannedPixelSpacing is used");
    }
    const DicomDataSet& stated = source == kPixelSpacing ? holder : file_;
    const std::vector<double> spacing = stated.numbers(source);
    if (spacing.size() < 2 || spacing[0] <= 0 || spacing[1] <= 0) {
      throw Unusable{"has a pixel spacing of '" + dicom_text(stated.text(source)) +
                     "', expected two positive lengths"};
    }
    frame.spacing_y = spacing[0];  // the distance between rows comes first
    frame.spacing_x = spacing[1];
  }

  void warn_once(const std::string& warning) {
    if (std::ranges::find(image_.warnings, warning) == image_.warnings.end()) {
      image_.warnings.push_back(warning);
    }
  }

  // Reads frames that follow each other along the normal, from one position that the file states.
  std::vector<DicomFrame> frames_without_positions() {
    const FrameAttributes attributes(file_, 0);
    const bool is_nuclear = image_.sop_class == kNuclearClass;
    const DicomDataSet* detector = is_nuclear ? file_.first_item(kDetectorInformation) : nullptr;
    const DicomDataSet& plane =
        detector != nullptr && detector->has(kImagePosition) ? *detector : file_;
    if (is_nuclear && !contains(file_.texts(kImageType), "RECON")) {
      throw Unusable{"is a nuclear medicine image of type " +
                     dicom_text(joined(file_.texts(kImageType))) +
                     ", whose frames are not slices of a volume"};
    }
    DicomFrame first;
    const DicomDataSet* shared_orientation = attributes.group(kPlaneOrientation);
    set_orientation(
        (shared_orientation != nullptr ? *shared_orientation : plane).numbers(kImageOrientation),
        plane, first);
    set_position(plane.numbers(kImagePosition), first);
    read_spacing(attributes, first);
    std::vector<DicomFrame> all(image_.frames, first);
    const std::vector<Vec3> positions =
        file_.has(kGridFrameOffsets) ? positions_by_offsets(first) : positions_by_spacing(first);
    for (std::size_t i = 0; i < all.size(); ++i) {
      all[i].number = i;
      all[i].position = positions[i];
    }
    return all;
  }

  // Reads the frames of a dose grid. The offsets start at 0, or are coordinates along the patient's
  // z axis.
  std::vector<Vec3> positions_by_offsets(const DicomFrame& first) {
    constexpr double kSamePlace = 1e-3;
    const std::vector<double> offsets = file_.numbers(kGridFrameOffsets);
    if (offsets.size() != image_.frames) {
      throw Unusable{"has " + std::to_string(image_.frames) + " frames, but " +
                     std::to_string(offsets.size()) + " offsets (GridFrameOffsetVector)"};
    }
    const bool are_coordinates = offsets[0] != 0;
    if (are_coordinates && std::abs(offsets[0] - first.position.z) > kSamePlace) {
      throw Unusable{"has a GridFrameOffsetVector that starts at " + dicom_number(offsets[0]) +
                     ", expected 0 or its position's z, " + dicom_number(first.position.z)};
    }
    image_.position_source = are_coordinates ? "GridFrameOffsetVector (z coordinates)"
                                             : "GridFrameOffsetVector (from the first frame)";
    std::vector<Vec3> positions;
    for (const double offset : offsets) {
      positions.push_back(are_coordinates ? Vec3{first.position.x, first.position.y, offset}
                                          : moved(first.position, unit_normal(first), offset));
    }
    return positions;
  }

  std::vector<Vec3> positions_by_spacing(const DicomFrame& first) {
    const std::vector<DicomTag> pointers = file_.tags(kFrameIncrementPointer);
    const bool is_cine = std::ranges::any_of(
        pointers, [](DicomTag tag) { return tag == kFrameTime || tag == kFrameTimeVector; });
    const std::optional<double> spacing = file_.number(kSpacingBetweenSlices);
    if (is_cine || !spacing || *spacing == 0) {
      throw Unusable{
          "has " + std::to_string(image_.frames) + " frames that " +
          (is_cine ? "follow each other in time"
                   : "state no positions (ImagePositionPatient) and no SpacingBetweenSlices")};
    }
    const std::vector<double> slices = file_.numbers(kSliceVector);
    if (!slices.empty() && slices.size() != image_.frames) {
      throw Unusable{"has " + std::to_string(image_.frames) + " frames, but a SliceVector of " +
                     std::to_string(slices.size())};
    }
    image_.position_source = "SpacingBetweenSlices " + dicom_number(*spacing);
    std::vector<Vec3> positions;
    for (std::size_t i = 0; i < image_.frames; ++i) {
      const double slice = slices.empty() ? static_cast<double>(i) : slices[i] - 1;
      positions.push_back(moved(first.position, unit_normal(first), *spacing * slice));
    }
    return positions;
  }

  // The other lists that describe the frames of a nuclear medicine image.
  void add_vector_labels(const DicomFrame& frame) {
    constexpr std::array<std::pair<DicomTag, std::string_view>, 8> kVectors{
        {{kEnergyWindowVector, "energy window"},
         {kDetectorVector, "detector"},
         {kPhaseVector, "phase"},
         {kRotationVector, "rotation"},
         {kIntervalVector, "R-R interval"},
         {kTimeSlotVector, "time slot"},
         {kAngularViewVector, "view"},
         {kTimeSliceVector, "time slice"}}};
    if (!vectors_) {
      vectors_.emplace();
      for (const auto& [tag, name] : kVectors) vectors_->emplace_back(name, file_.numbers(tag));
    }
    for (const auto& [name, values] : *vectors_) {
      if (values.size() == image_.frames) {
        labels_.push_back({std::string(name), dicom_number(values[frame.number]), Kind::volume});
      }
    }
  }

  void read_rescale(const FrameAttributes& attributes, DicomFrame& frame) {
    if (file_.has(kDoseGridScaling)) {
      frame.slope = number_of(file_, kDoseGridScaling, "DoseGridScaling", 1);
      image_.dose_units =
          file_.text(kDoseUnits).empty() ? "unit not stated" : dicom_text(file_.text(kDoseUnits));
    } else if (image_.sop_class == kParametricMapClass) {
      read_real_world_mapping(attributes, frame);
    } else {
      const DicomDataSet* group = attributes.group(kPixelValueTransformation);
      const DicomDataSet& holder = group != nullptr ? *group : file_;
      frame.slope = number_of(holder, kRescaleSlope, "RescaleSlope", 1);
      frame.intercept = number_of(holder, kRescaleIntercept, "RescaleIntercept", 0);
      image_.rescale_type = dicom_text(holder.text(kRescaleType));
    }
    if (frame.slope == 0) {
      frame.slope = 1;
      warn_once("states a rescale slope of 0; 1 is used");
    }
  }

  void read_real_world_mapping(const FrameAttributes& attributes, DicomFrame& frame) {
    const DicomDataSet* mapping = attributes.group(kRealWorldMapping);
    mapping = mapping != nullptr ? mapping : file_.first_item(kRealWorldMapping);
    if (mapping == nullptr) {
      return;
    }
    if (mapping->has(kRealWorldTable)) {
      throw Unusable{
          "maps its samples to values by a table (RealWorldValueLUTData), which isoatlas does not "
          "apply"};
    }
    frame.slope = number_of(*mapping, kRealWorldSlope, "RealWorldValueSlope", 1);
    frame.intercept = number_of(*mapping, kRealWorldIntercept, "RealWorldValueIntercept", 0);
  }

  static double number_of(const DicomDataSet& holder, DicomTag tag, const std::string& name,
                          double otherwise) {
    if (!holder.has(tag)) {
      return otherwise;
    }
    const std::optional<double> value = holder.number(tag);
    if (!value) {
      throw Unusable{"has a " + name + " of '" + dicom_text(holder.text(tag)) +
                     "', expected a number"};
    }
    return *value;
  }

  void add_label(const DicomDataSet& holder, DicomTag tag, const std::string& name, Kind kind) {
    if (holder.has(tag)) {
      const bool is_clock = tag == kAcquisitionDateTime || tag == kAcquisitionTime ||
                            tag == kContentTime;  // "080000" is a time, not a number
      const std::vector<double> numbers = is_clock ? std::vector<double>() : holder.numbers(tag);
      std::vector<std::string> values{dicom_text(holder.text(tag))};
      if (!numbers.empty()) {
        values.clear();
        std::ranges::transform(numbers, std::back_inserter(values),
                               dicom_number);  // "2" and "2.0" are equal
      }
      labels_.push_back({name, joined(values), kind});
    }
  }

  void add_labels(const FrameAttributes& attributes, DicomFrame& frame) {
    if (attributes.has_groups()) {
      add_group_labels(attributes, frame);
    }
    add_vector_labels(frame);
    add_label(file_, kTemporalPosition, "time point", Kind::volume);
    add_label(file_, kTriggerTime, "trigger time", Kind::time);
    add_label(file_, kEchoNumbers, "echo", Kind::volume);
    add_label(file_, kEchoTime, "echo time", Kind::volume);
    add_label(file_, kDiffusionBValue, "b-value", Kind::volume);
    add_label(file_, kInversionTime, "inversion time", Kind::time);
    add_label(file_, kFlipAngle, "flip angle", Kind::time);
    add_label(file_, kAcquisitionNumber, "acquisition", Kind::time);
    add_label(file_, kAcquisitionDateTime, "acquisition time", Kind::time);
    add_label(file_, kAcquisitionTime, "acquisition time", Kind::time);
    add_label(file_, kContentTime, "content time", Kind::time);
    add_label(file_, kImageType, "image type", Kind::other);
    add_label(file_, kSliceThickness, "slice thickness", Kind::other);
    add_label(file_, kSequenceName, "sequence", Kind::other);
    add_label(file_, kConvolutionKernel, "kernel", Kind::other);
    if (image_.frames > 1) {
      labels_.push_back({"image", std::to_string(image_.instance_number), Kind::time});
    }
  }

  void add_group_labels(const FrameAttributes& attributes, DicomFrame& frame) {
    const auto add = [&](DicomTag sequence, DicomTag tag, const std::string& name, Kind kind) {
      if (const DicomDataSet* group = attributes.group(sequence)) {
        add_label(*group, tag, name, kind);
      }
    };
    if (const DicomDataSet* content = attributes.group(kFrameContent)) {
      frame.stack = content->text(kStackId);
    }
    add(kFrameContent, kTemporalPositionIndex, "time point", Kind::volume);
    add(kCardiacSynchronization, kTriggerDelay, "trigger delay", Kind::time);
    add(kMrEchoes, kEffectiveEchoTime, "echo time", Kind::volume);
    add(kMrDiffusion, kDiffusionBValue, "b-value", Kind::volume);
    if (const DicomDataSet* diffusion = attributes.group(kMrDiffusion)) {
      if (const DicomDataSet* direction = diffusion->first_item(kDiffusionDirections)) {
        add_label(*direction, kDiffusionOrientation, "gradient direction", Kind::volume);
      }
    }
    for (const DicomTag sequence : {kMrFrameType, kCtFrameType, kPetFrameType}) {
      add(sequence, kFrameType, "frame type", Kind::other);
      add(sequence, kComplexImageComponent, "complex component", Kind::other);
    }
    add_dimension_labels(attributes);
  }

  // Adds the indices of a frame in the writer's own dimensions, except the dimension along the
  // slices.
  void add_dimension_labels(const FrameAttributes& attributes) {
    const DicomDataSet* content = attributes.group(kFrameContent);
    if (content == nullptr) {
      return;
    }
    const std::vector<double> indices = content->numbers(kDimensionIndexValues);
    const std::vector<DicomDataSet>& dimensions = file_.items(kDimensionIndices);
    for (std::size_t i = 0; i < std::min(indices.size(), dimensions.size()); ++i) {
      const std::vector<DicomTag> pointers = dimensions[i].tags(kDimensionIndexPointer);
      constexpr std::array kPositionTags{kStackId, kInStackPosition, kImagePosition,
                                         kImagePositionVolume};
      if (!pointers.empty() &&
          std::ranges::find(kPositionTags, pointers.front()) == kPositionTags.end()) {
        const std::string label = dicom_text(dimensions[i].text(kDimensionLabel));
        labels_.push_back({label.empty() ? "dimension " + std::to_string(i) : label,
                           dicom_number(indices[i]), Kind::time});
      }
    }
  }

  const DicomContents& contents_;
  const DicomDataSet& file_;
  DicomImage& image_;
  std::vector<DicomLabel> labels_;  // labels of the current frame
  std::optional<std::vector<std::pair<std::string_view, std::vector<double>>>>
      vectors_;  // see add_vector_labels
};

std::shared_ptr<DicomImage> image_of(const fs::path& path, const std::string& name,
                                     const DicomContents& contents) {
  const DicomDataSet& file = contents.attributes;
  auto image = std::make_shared<DicomImage>();
  image->path = path;
  image->name = name;
  image->series = dicom_text(file.text(kSeriesInstance));
  image->world = file.text(kPatientId) + "\n" + file.text(kStudyInstance) + "\n" +
                 file.text(kFrameOfReference);
  image->series_number = dicom_text(file.text(kSeriesNumber));
  image->description = dicom_text(file.text(kSeriesDescription));
  image->modality = dicom_text(file.text(kModality));
  image->sop_class = file.text(kSopClass);
  image->instance_number = file.integer(kInstanceNumber).value_or(0);
  image->is_localizer = contains(file.texts(kImageType), "LOCALIZER");
  image->rows =
      static_cast<std::size_t>(std::max<std::int64_t>(file.integer(kRows).value_or(0), 0));
  image->columns =
      static_cast<std::size_t>(std::max<std::int64_t>(file.integer(kColumns).value_or(0), 0));
  image->frames = static_cast<std::size_t>(
      std::max<std::int64_t>(file.integer(kNumberOfFrames).value_or(1), 1));
  image->pixels = *contents.pixels;
  image->transfer_syntax = contents.transfer_syntax;
  image->is_big_endian = contents.is_big_endian;
  image->is_lossy = file.text(kLossyCompression) == "01";
  if (const std::optional<double> padding = file.number(kPixelPaddingValue)) {
    image->padding = dicom_number(*padding);
  }
  return image;
}

}  // namespace

std::string DicomFrame::name() const {
  return image->frames == 1 ? image->name
                            : "frame " + std::to_string(number + 1) + " of " + image->name;
}

DicomFileFrames read_dicom_frames(const fs::path& path, const std::string& name,
                                  std::uint64_t max_memory) {
  const DicomContents contents = read_dicom_contents(path, max_memory);
  const DicomDataSet& file = contents.attributes;
  DicomFileFrames result;
  result.series = dicom_text(file.text(kSeriesInstance));
  result.modality = dicom_text(file.text(kModality));
  result.is_directory = file.text(kSopClass) == kDirectoryClass;
  result.is_image = contents.pixels.has_value();
  if (contents.is_cut_off && (!result.is_image || result.series.empty())) {
    throw bad_file(path, "is cut off: its data elements extend beyond its " +
                             std::to_string(contents.bytes) + " bytes");
  }
  if (!result.is_image) {
    result.unusable =
        "holds no image" + (result.modality.empty() ? std::string() : " (" + result.modality + ")");
    return result;
  }
  const std::shared_ptr<DicomImage> image = image_of(path, name, contents);
  result.rows = image->rows;
  result.columns = image->columns;
  try {
    result.frames = ImageReading(contents, *image).frames(max_memory);
    for (DicomFrame& frame : result.frames) {
      frame.image = image;
    }
  } catch (const Unusable& unusable) {
    result.unusable = unusable.why;
  }
  return result;
}

std::string dicom_text(const std::string& text) {
  std::string valid;
  for (std::size_t i = 0; i < text.size();) {
    const auto lead = static_cast<unsigned char>(text[i]);
    const std::size_t length = lead < 0x80             ? 1
                               : lead >> 5U == 0b110   ? 2
                               : lead >> 4U == 0b1110  ? 3
                               : lead >> 3U == 0b11110 ? 4
                                                       : 0;
    bool is_valid = length > 0 && i + length <= text.size();
    for (std::size_t k = 1; is_valid && k < length; ++k) {
      is_valid = static_cast<unsigned char>(text[i + k]) >> 6U == 0b10;
    }
    valid += is_valid ? text.substr(i, length) : "?";
    i += is_valid ? length : 1;
  }
  return one_line(valid);
}

std::string dicom_number(double value) {
  std::array<char, 32> text{};
  const bool is_plain = value == 0 || (std::abs(value) >= 1e-5 &&
                                       std::abs(value) < 1e15);  // otherwise with an exponent
  const auto [end, error] = is_plain ? std::to_chars(text.data(), text.data() + text.size(), value,
                                                     std::chars_format::fixed)
                                     : std::to_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} ? std::string(text.data(), end) : std::to_string(value);
}

}  // namespace isoatlas::detail::io
