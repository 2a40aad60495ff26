// SPDX-License-Identifier: Apache-2.0
// The attributes of a DICOM data set that isoatlas uses, with their names in the standard.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace isoatlas::detail::io {

/// A tag as one number: the group in the upper 16 bits, the element in the lower.
using DicomTag = std::uint32_t;

// The attributes that are kept, with their names in the standard (PS3.6); others are skipped.
namespace dicom {
inline constexpr DicomTag kTransferSyntax = 0x00020010, kImageType = 0x00080008,
                          kSopClass = 0x00080016, kSopInstance = 0x00080018,
                          kAcquisitionDateTime = 0x0008002A, kAcquisitionTime = 0x00080032,
                          kContentTime = 0x00080033, kModality = 0x00080060,
                          kSeriesDescription = 0x0008103E, kFrameType = 0x00089007,
                          kComplexImageComponent = 0x00089208, kPatientId = 0x00100020;
inline constexpr DicomTag kSequenceName = 0x00180024, kSliceThickness = 0x00180050,
                          kEchoTime = 0x00180081, kInversionTime = 0x00180082,
                          kEchoNumbers = 0x00180086, kSpacingBetweenSlices = 0x00180088,
                          kTriggerTime = 0x00181060, kImagerPixelSpacing = 0x00181164,
                          kConvolutionKernel = 0x00181210, kFlipAngle = 0x00181314,
                          kNominalScannedPixelSpacing = 0x00182010,
                          kDiffusionDirections = 0x00189076, kEffectiveEchoTime = 0x00189082,
                          kDiffusionBValue = 0x00189087, kDiffusionOrientation = 0x00189089,
                          kMrEchoes = 0x00189114, kMrDiffusion = 0x00189117,
                          kCardiacSynchronization = 0x00189118, kMrFrameType = 0x00189226,
                          kCtFrameType = 0x00189329, kPetFrameType = 0x00189751;
inline constexpr DicomTag kPrivateCreator19 = 0x00190010,
                          kMosaicImages =
                              0x0019100A;  // the second is a private attribute of Siemens
inline constexpr DicomTag kStudyInstance = 0x0020000D, kFrameOfReference = 0x00200052,
                          kSeriesInstance = 0x0020000E, kSeriesNumber = 0x00200011,
                          kAcquisitionNumber = 0x00200012, kInstanceNumber = 0x00200013,
                          kImagePosition = 0x00200032, kImageOrientation = 0x00200037,
                          kTemporalPosition = 0x00200100, kStackId = 0x00209056,
                          kFrameContent = 0x00209111, kPlanePosition = 0x00209113,
                          kPlaneOrientation = 0x00209116, kTemporalPositionIndex = 0x00209128,
                          kTriggerDelay = 0x00209153, kDimensionIndexValues = 0x00209157,
                          kDimensionIndexPointer = 0x00209165, kDimensionIndices = 0x00209222,
                          kImagePositionVolume = 0x00209301, kImageOrientationVolume = 0x00209302,
                          kPlanePositionVolume = 0x0020930E, kPlaneOrientationVolume = 0x0020930F,
                          kDimensionLabel = 0x00209421, kInStackPosition = 0x00209057;
inline constexpr DicomTag kSamplesPerPixel = 0x00280002, kPhotometricInterpretation = 0x00280004,
                          kNumberOfFrames = 0x00280008, kFrameIncrementPointer = 0x00280009,
                          kRows = 0x00280010, kColumns = 0x00280011, kPixelSpacing = 0x00280030,
                          kBitsAllocated = 0x00280100, kBitsStored = 0x00280101,
                          kHighBit = 0x00280102, kPixelRepresentation = 0x00280103,
                          kPixelPaddingValue = 0x00280120, kRescaleIntercept = 0x00281052,
                          kRescaleSlope = 0x00281053, kRescaleType = 0x00281054,
                          kLossyCompression = 0x00282110, kModalityTable = 0x00283000,
                          kPixelMeasures = 0x00289110, kPixelValueTransformation = 0x00289145;
inline constexpr DicomTag kRealWorldMapping = 0x00409096, kRealWorldTable = 0x00409212,
                          kRealWorldIntercept = 0x00409224, kRealWorldSlope = 0x00409225;
inline constexpr DicomTag kEnergyWindowVector = 0x00540010, kDetectorVector = 0x00540020,
                          kDetectorInformation = 0x00540022, kPhaseVector = 0x00540030,
                          kRotationVector = 0x00540050, kIntervalVector = 0x00540060,
                          kTimeSlotVector = 0x00540070, kSliceVector = 0x00540080,
                          kAngularViewVector = 0x00540090, kTimeSliceVector = 0x00540100;
inline constexpr DicomTag kDoseUnits = 0x30040002, kGridFrameOffsets = 0x3004000C,
                          kDoseGridScaling = 0x3004000E;
inline constexpr DicomTag kSharedGroups = 0x52009229, kPerFrameGroups = 0x52009230;
inline constexpr DicomTag kFloatPixelData = 0x7FE00008, kDoublePixelData = 0x7FE00009,
                          kPixelData = 0x7FE00010;
}  // namespace dicom

class DicomDataSet;

struct DicomAttribute {
  DicomTag tag = 0;
  std::string type;                 ///< the standard's value representation: "DS", "US", "SQ", ...
  std::string value;                ///< as in the file, little endian
  std::vector<DicomDataSet> items;  ///< of a sequence
};

/// The kept attributes of a data set or of an item of a sequence. An empty attribute counts as
/// absent.
class DicomDataSet {
 public:
  /// Adds an attribute; if its tag exists already, the first attribute is kept.
  void add(DicomAttribute attribute) {
    if (find(attribute.tag) == nullptr) attributes_.push_back(std::move(attribute));
  }

  bool has(DicomTag tag) const;
  std::string text(
      DicomTag tag) const;  ///< one line without outer blanks; several values stay joined
  std::vector<std::string> texts(DicomTag tag) const;  ///< values between backslashes
  std::vector<double> numbers(DicomTag tag) const;   ///< empty if one of the values is not a number
  std::optional<double> number(DicomTag tag) const;  ///< the first value
  std::optional<std::int64_t> integer(DicomTag tag) const;
  std::vector<DicomTag> tags(DicomTag tag) const;  ///< values that are tags
  const std::vector<DicomDataSet>& items(DicomTag tag) const;
  const DicomDataSet* first_item(DicomTag tag) const;  ///< null if it has no items

 private:
  const DicomAttribute* find(DicomTag tag) const;
  std::vector<DicomAttribute> attributes_;
};

/// The standard's type of a kept attribute; empty if the attribute is skipped.
std::string_view dicom_type(DicomTag tag);

/// Bytes of one value of a binary type, whose byte order depends on the file's; 0 for text and for
/// bytes, which have no byte order.
std::size_t dicom_value_bytes(std::string_view type);

/// `text` without the blanks and zeros that pad values.
std::string_view dicom_trimmed(std::string_view text);

}  // namespace isoatlas::detail::io
