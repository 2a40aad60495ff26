// SPDX-License-Identifier: Apache-2.0
// Based on: DICOM PS3.5 section 6 (values), PS3.6 (data dictionary).
#include "volume_files/dicom_data_set.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <utility>

#include "files/number_text.h"

namespace isoatlas::detail::io {

using namespace dicom;

namespace {

constexpr std::string_view kDicomPadding{" \0\t\r\n", 5};

struct KnownAttribute {
  DicomTag tag;
  std::string_view type;
};

constexpr std::array kKnownAttributes{KnownAttribute{kTransferSyntax, "UI"},
                                      KnownAttribute{kImageType, "CS"},
                                      KnownAttribute{kSopClass, "UI"},
                                      KnownAttribute{kSopInstance, "UI"},
                                      KnownAttribute{kAcquisitionDateTime, "DT"},
                                      KnownAttribute{kAcquisitionTime, "TM"},
                                      KnownAttribute{kContentTime, "TM"},
                                      KnownAttribute{kModality, "CS"},
                                      KnownAttribute{kSeriesDescription, "LO"},
                                      KnownAttribute{kFrameType, "CS"},
                                      KnownAttribute{kComplexImageComponent, "CS"},
                                      KnownAttribute{kPatientId, "LO"},
                                      KnownAttribute{kSequenceName, "SH"},
                                      KnownAttribute{kSliceThickness, "DS"},
                                      KnownAttribute{kEchoTime, "DS"},
                                      KnownAttribute{kInversionTime, "DS"},
                                      KnownAttribute{kEchoNumbers, "IS"},
                                      KnownAttribute{kSpacingBetweenSlices, "DS"},
                                      KnownAttribute{kTriggerTime, "DS"},
                                      KnownAttribute{kImagerPixelSpacing, "DS"},
                                      KnownAttribute{kConvolutionKernel, "SH"},
                                      KnownAttribute{kFlipAngle, "DS"},
                                      KnownAttribute{kNominalScannedPixelSpacing, "DS"},
                                      KnownAttribute{kDiffusionDirections, "SQ"},
                                      KnownAttribute{kEffectiveEchoTime, "FD"},
                                      KnownAttribute{kDiffusionBValue, "FD"},
                                      KnownAttribute{kDiffusionOrientation, "FD"},
                                      KnownAttribute{kMrEchoes, "SQ"},
                                      KnownAttribute{kMrDiffusion, "SQ"},
                                      KnownAttribute{kCardiacSynchronization, "SQ"},
                                      KnownAttribute{kMrFrameType, "SQ"},
                                      KnownAttribute{kCtFrameType, "SQ"},
                                      KnownAttribute{kPetFrameType, "SQ"},
                                      KnownAttribute{kPrivateCreator19, "LO"},
                                      KnownAttribute{kMosaicImages, "US"},
                                      KnownAttribute{kStudyInstance, "UI"},
                                      KnownAttribute{kSeriesInstance, "UI"},
                                      KnownAttribute{kSeriesNumber, "IS"},
                                      KnownAttribute{kAcquisitionNumber, "IS"},
                                      KnownAttribute{kInstanceNumber, "IS"},
                                      KnownAttribute{kImagePosition, "DS"},
                                      KnownAttribute{kImageOrientation, "DS"},
                                      KnownAttribute{kFrameOfReference, "UI"},
                                      KnownAttribute{kTemporalPosition, "IS"},
                                      KnownAttribute{kStackId, "SH"},
                                      KnownAttribute{kInStackPosition, "UL"},
                                      KnownAttribute{kFrameContent, "SQ"},
                                      KnownAttribute{kPlanePosition, "SQ"},
                                      KnownAttribute{kPlaneOrientation, "SQ"},
                                      KnownAttribute{kTemporalPositionIndex, "UL"},
                                      KnownAttribute{kTriggerDelay, "FD"},
                                      KnownAttribute{kDimensionIndexValues, "UL"},
                                      KnownAttribute{kDimensionIndexPointer, "AT"},
                                      KnownAttribute{kDimensionIndices, "SQ"},
                                      KnownAttribute{kImagePositionVolume, "FD"},
                                      KnownAttribute{kImageOrientationVolume, "FD"},
                                      KnownAttribute{kPlanePositionVolume, "SQ"},
                                      KnownAttribute{kPlaneOrientationVolume, "SQ"},
                                      KnownAttribute{kDimensionLabel, "LO"},
                                      KnownAttribute{kSamplesPerPixel, "US"},
                                      KnownAttribute{kPhotometricInterpretation, "CS"},
                                      KnownAttribute{kNumberOfFrames, "IS"},
                                      KnownAttribute{kFrameIncrementPointer, "AT"},
                                      KnownAttribute{kRows, "US"},
                                      KnownAttribute{kColumns, "US"},
                                      KnownAttribute{kPixelSpacing, "DS"},
                                      KnownAttribute{kBitsAllocated, "US"},
                                      KnownAttribute{kBitsStored, "US"},
                                      KnownAttribute{kHighBit, "US"},
                                      KnownAttribute{kPixelRepresentation, "US"},
                                      KnownAttribute{kPixelPaddingValue, "US"},
                                      KnownAttribute{kRescaleIntercept, "DS"},
                                      KnownAttribute{kRescaleSlope, "DS"},
                                      KnownAttribute{kRescaleType, "LO"},
                                      KnownAttribute{kLossyCompression, "CS"},
                                      KnownAttribute{kModalityTable, "SQ"},
                                      KnownAttribute{kPixelMeasures, "SQ"},
                                      KnownAttribute{kPixelValueTransformation, "SQ"},
                                      KnownAttribute{kRealWorldMapping, "SQ"},
                                      KnownAttribute{kRealWorldTable, "FD"},
                                      KnownAttribute{kRealWorldIntercept, "FD"},
                                      KnownAttribute{kRealWorldSlope, "FD"},
                                      KnownAttribute{kEnergyWindowVector, "US"},
                                      KnownAttribute{kDetectorVector, "US"},
                                      KnownAttribute{kDetectorInformation, "SQ"},
                                      KnownAttribute{kPhaseVector, "US"},
                                      KnownAttribute{kRotationVector, "US"},
                                      KnownAttribute{kIntervalVector, "US"},
                                      KnownAttribute{kTimeSlotVector, "US"},
                                      KnownAttribute{kSliceVector, "US"},
                                      KnownAttribute{kAngularViewVector, "US"},
                                      KnownAttribute{kTimeSliceVector, "US"},
                                      KnownAttribute{kDoseUnits, "CS"},
                                      KnownAttribute{kGridFrameOffsets, "DS"},
                                      KnownAttribute{kDoseGridScaling, "DS"},
                                      KnownAttribute{kSharedGroups, "SQ"},
                                      KnownAttribute{kPerFrameGroups, "SQ"}};

static_assert(std::ranges::is_sorted(kKnownAttributes, {}, &KnownAttribute::tag));

std::optional<double> number_in(std::string_view text) {
  text = dicom_trimmed(text);
  double value = 0;
  return parse_number(text, value) && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

template <class Number>
std::vector<double> numbers_in(const std::string& bytes) {
  std::vector<double> values;
  for (std::size_t at = 0; at + sizeof(Number) <= bytes.size(); at += sizeof(Number)) {
    Number value{};
    std::memcpy(&value, bytes.data() + at, sizeof value);
    if (!std::isfinite(static_cast<double>(value))) {
      return {};
    }
    values.push_back(static_cast<double>(value));
  }
  return values;
}

}  // namespace

std::string_view dicom_type(DicomTag tag) {
  const auto* known = std::ranges::lower_bound(kKnownAttributes, tag, {}, &KnownAttribute::tag);
  return known == kKnownAttributes.end() || known->tag != tag ? std::string_view{} : known->type;
}

std::string_view dicom_trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kDicomPadding);
  if (first == std::string_view::npos) {
    return {};
  }
  return text.substr(first, text.find_last_not_of(kDicomPadding) - first + 1);
}

std::size_t dicom_value_bytes(std::string_view type) {
  if (type == "US" || type == "SS" || type == "AT" || type == "OW") return 2;
  if (type == "UL" || type == "SL" || type == "FL" || type == "OF" || type == "OL") return 4;
  if (type == "FD" || type == "OD" || type == "SV" || type == "UV" || type == "OV") return 8;
  return 0;
}

const DicomAttribute* DicomDataSet::find(DicomTag tag) const {
  const auto found = std::ranges::find(attributes_, tag, &DicomAttribute::tag);
  return found == attributes_.end() ? nullptr : &*found;
}

bool DicomDataSet::has(DicomTag tag) const {
  const DicomAttribute* attribute = find(tag);
  if (attribute == nullptr || !attribute->items.empty()) {
    return attribute != nullptr;
  }
  return dicom_value_bytes(attribute->type) > 0 ? !attribute->value.empty()
                                                : !dicom_trimmed(attribute->value).empty();
}

std::string DicomDataSet::text(DicomTag tag) const {
  const DicomAttribute* attribute = find(tag);
  return attribute == nullptr ? std::string() : std::string(dicom_trimmed(attribute->value));
}

std::vector<std::string> DicomDataSet::texts(DicomTag tag) const {
  std::vector<std::string> values;
  const std::string all = text(tag);
  for (std::string_view rest = all; !rest.empty();) {
    const std::size_t end = std::min(rest.find('\\'), rest.size());
    values.emplace_back(dicom_trimmed(rest.substr(0, end)));
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return values;
}

std::vector<double> DicomDataSet::numbers(DicomTag tag) const {
  const DicomAttribute* attribute = find(tag);
  if (attribute == nullptr) {
    return {};
  }
  const std::string& type = attribute->type;
  if (type == "US") return numbers_in<std::uint16_t>(attribute->value);
  if (type == "SS") return numbers_in<std::int16_t>(attribute->value);
  if (type == "UL") return numbers_in<std::uint32_t>(attribute->value);
  if (type == "SL") return numbers_in<std::int32_t>(attribute->value);
  if (type == "FL") return numbers_in<float>(attribute->value);
  if (type == "FD") return numbers_in<double>(attribute->value);
  std::vector<double> values;
  for (const std::string& value : texts(tag)) {
    const std::optional<double> number = number_in(value);
    if (!number) {
      return {};
    }
    values.push_back(*number);
  }
  return values;
}

std::optional<double> DicomDataSet::number(DicomTag tag) const {
  const std::vector<double> values = numbers(tag);
  return values.empty() ? std::nullopt : std::optional(values.front());
}

std::optional<std::int64_t> DicomDataSet::integer(DicomTag tag) const {
  constexpr double kLargest = 9e15;
  const std::optional<double> value = number(tag);
  if (!value || std::abs(*value) > kLargest || *value != std::floor(*value)) {
    return std::nullopt;
  }
  return static_cast<std::int64_t>(*value);
}

std::vector<DicomTag> DicomDataSet::tags(DicomTag tag) const {
  std::vector<DicomTag> values;
  if (const DicomAttribute* attribute = find(tag)) {
    const std::vector<double> halves = numbers_in<std::uint16_t>(attribute->value);
    for (std::size_t i = 0; i + 1 < halves.size(); i += 2) {
      values.push_back(static_cast<DicomTag>(halves[i]) << 16U |
                       static_cast<DicomTag>(halves[i + 1]));
    }
  }
  return values;
}

const std::vector<DicomDataSet>& DicomDataSet::items(DicomTag tag) const {
  static const std::vector<DicomDataSet> none;
  const DicomAttribute* attribute = find(tag);
  return attribute == nullptr ? none : attribute->items;
}

const DicomDataSet* DicomDataSet::first_item(DicomTag tag) const {
  const std::vector<DicomDataSet>& all = items(tag);
  return all.empty() ? nullptr : &all.front();
}

}  // namespace isoatlas::detail::io
