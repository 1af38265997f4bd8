// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/images/image_codec.h"

#include <exception>
#include <opencv2/core.hpp>
#include <string>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/images/plain_png.h"
#ifdef PROSPECT_IMAGE_CODECS
#include <dlfcn.h>
#endif

namespace prospect {
namespace {

std::vector<std::uint8_t> encoded_without_codecs(const std::string& ending, const cv::Mat& pixels) {
  if (ending != ".png") return {};
  return plain_png(pixels);
}

}  // namespace

#ifdef PROSPECT_IMAGE_CODECS
namespace {

/// The functions of the library that is loaded.
struct Codecs {
  cv::Mat (*decode)(cv::InputArray, int);
  bool (*encode)(const cv::String&, cv::InputArray, std::vector<std::uint8_t>&,
                 const std::vector<int>&);
};

[[noreturn]] void refuse() {
  const char* why = dlerror();  // names the library first
  throw InputError(std::string(why ? why : PROSPECT_IMAGE_CODECS ": cannot be loaded") +
                   "; expected OpenCV's codecs of images");
}

template <typename Function>
void find(void* library, const char* name, Function*& function) {
  function = reinterpret_cast<Function*>(dlsym(library, name));
  if (function == nullptr) refuse();
}

Codecs load() {
  void* library = dlopen(PROSPECT_IMAGE_CODECS, RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) refuse();
  // cv::imdecode() and cv::imencode() by the linker's names, which hold the types of arguments.
  Codecs codecs{};
  find(library, "_ZN2cv8imdecodeERKNS_11_InputArrayEi", codecs.decode);
  find(library,
       "_ZN2cv8imencodeERKNSt7__cxx1112basic_stringIcSt11char_traitsIcESaIcEEERKNS_11_InputArrayE"
       "RSt6vectorIhSaIhEERKSB_IiSaIiEE",
       codecs.encode);
  return codecs;
}

const Codecs& codecs() {
  static const Codecs loaded = load();
  return loaded;
}

}  // namespace

void load_image_codecs() { codecs(); }

void load_image_codecs_if_there() noexcept {
  try {
    codecs();
  } catch (const std::exception&) {  // whoever needs them asks again, and is told
  }
}

cv::Mat decode_pixels(const cv::Mat& bytes, int flags) { return codecs().decode(bytes, flags); }

std::vector<std::uint8_t> encode_pixels(const std::string& ending, const cv::Mat& pixels,
                                        const std::vector<int>& parameters) {
  std::vector<std::uint8_t> bytes;
  try {
    codecs();
  } catch (const InputError&) {
    return encoded_without_codecs(ending, pixels);
  }
  if (!codecs().encode(ending, pixels, bytes, parameters)) bytes.clear();
  return bytes;
}
#else
// PNG alone, and written only.
void load_image_codecs() {}
void load_image_codecs_if_there() noexcept {}

cv::Mat decode_pixels(const cv::Mat&, int) {
  throw InputError(
      "images cannot be read: this build has no codecs (PROSPECT_COPYLEFT=OFF); expected one with "
      "OpenCV's");
}

std::vector<std::uint8_t> encode_pixels(const std::string& ending, const cv::Mat& pixels,
                                        const std::vector<int>&) {
  return encoded_without_codecs(ending, pixels);
}
#endif

}  // namespace prospect
