// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/problem_file/hdf5_archive.h"

#include <hdf5.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <set>
#include <stdexcept>
#include <utility>

namespace prospect {
namespace {

/// An HDF5 identifier and how to give it back.
class Handle {
 public:
  Handle() = default;
  Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  ~Handle() { reset(); }
  Handle(Handle&& other) noexcept
      : id_(std::exchange(other.id_, H5I_INVALID_HID)), close_(other.close_) {}
  Handle& operator=(Handle&& other) noexcept {
    reset();
    id_ = std::exchange(other.id_, H5I_INVALID_HID);
    close_ = other.close_;
    return *this;
  }
  bool valid() const { return id_ >= 0; }
  hid_t id() const { return id_; }
  void reset() {
    if (id_ >= 0) close_(id_);
    id_ = H5I_INVALID_HID;
  }

 private:
  hid_t id_ = H5I_INVALID_HID;
  herr_t (*close_)(hid_t) = nullptr;
};

/// Keeps HDF5 from printing its errors, and leaves its settings as they were.
class Silence {
 public:
  Silence() {
    H5Eget_auto2(H5E_DEFAULT, &print_, &data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  ~Silence() { H5Eset_auto2(H5E_DEFAULT, print_, data_); }
  Silence(const Silence&) = delete;
  Silence& operator=(const Silence&) = delete;

 private:
  H5E_auto2_t print_ = nullptr;
  void* data_ = nullptr;
};

/// After a damaged file HDF5 does not give back all of its own small blocks, and complains of that
/// when the program ends (1.10.8: "infinite loop closing library"), as long as its errors are
/// printed. By then nobody wants them. To be called when HDF5 is in use: what is registered later
/// comes first at the end.
void end_in_silence() {
  static const int registered = std::atexit([] { H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr); });
  static_cast<void>(registered);
}

/// What HDF5 says of its last error, at its root.
std::string last_error() {
  std::string text;
  const auto innermost = [](unsigned n, const H5E_error2_t* error, void* data) -> herr_t {
    if (n == 0 && error->desc != nullptr) *static_cast<std::string*>(data) = error->desc;
    return 0;
  };
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, innermost, &text);
  for (char& c : text) {
    if (c == '\n' || c == '\r') c = ' ';
  }
  return text.empty() ? "HDF5 gives no reason" : text;
}

Handle checked(hid_t id, herr_t (*close)(hid_t), const char* what) {
  if (id < 0) throw std::runtime_error(std::string(what) + " failed (" + last_error() + ")");
  return {id, close};
}

void checked(herr_t status, const char* what) {
  if (status < 0) throw std::runtime_error(std::string(what) + " failed (" + last_error() + ")");
}

/// A file in memory. HDF5 may not write one itself: where the disk is full, it crashes when the
/// program ends (1.10.8).
Handle memory_access() {
  constexpr std::size_t kIncrement = 1;
  Handle access = checked(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "H5Pcreate");
  checked(H5Pset_fapl_core(access.id(), kIncrement, false), "H5Pset_fapl_core");
  return access;
}

/// A name that no other file in memory has: HDF5 takes two of one name for the same file.
std::string unique_name() {
  static std::atomic<std::uint64_t> count{0};
  return "prospect problem " + std::to_string(count++) + " in memory";
}

/// Where a file in memory goes when it is closed. (H5Fget_file_image would give it before that:
/// still marked as open for writing, or, as it takes out the mark, with a wrong checksum.)
struct Image {
  std::unique_ptr<void, void (*)(void*)> bytes{nullptr, std::free};  // once the file is closed
  std::size_t size = 0;
};

H5FD_file_image_callbacks_t image_callbacks(Image& image) {
  using Op = H5FD_file_image_op_t;
  H5FD_file_image_callbacks_t c;
  c.image_malloc = [](std::size_t size, Op, void*) { return std::malloc(size); };
  c.image_memcpy = [](void* to, const void* from, std::size_t size, Op, void*) {
    return std::memcpy(to, from, size);
  };
  c.image_realloc = [](void* buffer, std::size_t size, Op, void* data) {
    static_cast<Image*>(data)->size = size;
    return std::realloc(buffer, size);
  };
  c.image_free = [](void* buffer, Op op, void* data) -> herr_t {
    Image& kept = *static_cast<Image*>(data);
    if (op == H5FD_FILE_IMAGE_OP_FILE_CLOSE) {
      kept.bytes.reset(buffer);
    } else {
      std::free(buffer);
    }
    return 0;
  };
  c.udata_copy = [](void* data) { return data; };
  c.udata_free = [](void*) -> herr_t { return 0; };
  c.udata = &image;
  return c;
}

struct StoredType {
  hid_t file, memory;
};

StoredType stored(Archive::Type type) {
  switch (type) {
    case Archive::Type::kFloat64:
      return {H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE};
    case Archive::Type::kInt64:
      return {H5T_STD_I64LE, H5T_NATIVE_INT64};
    case Archive::Type::kUInt64:
      return {H5T_STD_U64LE, H5T_NATIVE_UINT64};
    case Archive::Type::kUInt8:
      return {H5T_STD_U8LE, H5T_NATIVE_UINT8};
  }
  throw std::logic_error("HDF5 archive: a type without a place in a file");
}

std::vector<hsize_t> dimensions(const Archive::Shape& shape) {
  return {shape.begin(), shape.end()};
}

Handle space_of(const Archive::Shape& shape) {
  if (shape.empty()) return checked(H5Screate(H5S_SCALAR), H5Sclose, "H5Screate");
  const std::vector<hsize_t> dims = dimensions(shape);
  return checked(H5Screate_simple(static_cast<int>(dims.size()), dims.data(), nullptr), H5Sclose,
                 "H5Screate_simple");
}

/// Text of a fixed length, UTF-8, filled up with zeros.
Handle text_type(std::size_t length) {
  Handle type = checked(H5Tcopy(H5T_C_S1), H5Tclose, "H5Tcopy");
  checked(H5Tset_size(type.id(), std::max<std::size_t>(length, 1)), "H5Tset_size");
  checked(H5Tset_strpad(type.id(), H5T_STR_NULLPAD), "H5Tset_strpad");
  checked(H5Tset_cset(type.id(), H5T_CSET_UTF8), "H5Tset_cset");
  return type;
}

/// Lists of names that are longer than this are none of ours.
constexpr std::size_t kMostTexts = 100000;

}  // namespace

struct Hdf5Writer::Impl {
  Silence silence;
  Image image;
  Handle file;
  Handle group_creation;
  std::vector<Handle> groups;  // from the root to the present one

  hid_t here() const { return groups.back().id(); }

  Handle dataset_creation(const Shape& shape, std::size_t bytes, bool of_bytes) const {
    // Small data are part of the metadata, and covered by their checksum.
    constexpr std::size_t kCompact = 2048;
    constexpr unsigned kEffort = 9;
    Handle plist = checked(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "H5Pcreate");
    checked(H5Pset_obj_track_times(plist.id(), false), "H5Pset_obj_track_times");
    if (bytes <= kCompact) {
      checked(H5Pset_layout(plist.id(), H5D_COMPACT), "H5Pset_layout");
      return plist;
    }
    const std::vector<hsize_t> chunk = dimensions(shape);
    checked(H5Pset_chunk(plist.id(), static_cast<int>(chunk.size()), chunk.data()), "H5Pset_chunk");
    if (!of_bytes) checked(H5Pset_shuffle(plist.id()), "H5Pset_shuffle");
    checked(H5Pset_deflate(plist.id(), kEffort), "H5Pset_deflate");
    // Last: of what is in the file, so that a wrong bit is found before anything is unpacked.
    checked(H5Pset_fletcher32(plist.id()), "H5Pset_fletcher32");
    return plist;
  }
};

Hdf5Writer::Hdf5Writer() : impl_(std::make_unique<Impl>()) {
  const Handle access = memory_access();
  checked(H5Pset_libver_bounds(access.id(), H5F_LIBVER_V110, H5F_LIBVER_V110),
          "H5Pset_libver_bounds");
  H5FD_file_image_callbacks_t callbacks = image_callbacks(impl_->image);
  checked(H5Pset_file_image_callbacks(access.id(), &callbacks), "H5Pset_file_image_callbacks");
  // Attributes and links in the headers of their groups, however many.
  const auto compact = [](hid_t plist) {
    checked(H5Pset_obj_track_times(plist, false), "H5Pset_obj_track_times");
    checked(H5Pset_attr_phase_change(plist, 1000, 0), "H5Pset_attr_phase_change");
    checked(H5Pset_link_phase_change(plist, 1000, 0), "H5Pset_link_phase_change");
  };
  const Handle creation = checked(H5Pcreate(H5P_FILE_CREATE), H5Pclose, "H5Pcreate");
  compact(creation.id());
  impl_->group_creation = checked(H5Pcreate(H5P_GROUP_CREATE), H5Pclose, "H5Pcreate");
  compact(impl_->group_creation.id());
  impl_->file = checked(H5Fcreate(unique_name().c_str(), H5F_ACC_TRUNC, creation.id(), access.id()),
                        H5Fclose, "H5Fcreate");
  impl_->groups.push_back(
      checked(H5Gopen2(impl_->file.id(), "/", H5P_DEFAULT), H5Gclose, "H5Gopen"));
}

Hdf5Writer::~Hdf5Writer() = default;

std::string Hdf5Writer::finish() {
  impl_->groups.clear();
  impl_->group_creation.reset();
  checked(H5Fflush(impl_->file.id(), H5F_SCOPE_GLOBAL), "H5Fflush");
  impl_->file.reset();
  const Image& image = impl_->image;
  if (!image.bytes) throw std::runtime_error("H5Fclose failed (" + last_error() + ")");
  return {static_cast<const char*>(image.bytes.get()), image.size};
}

void Hdf5Writer::attribute(const char* name, Type type, const Shape& shape, void* data) {
  const StoredType t = stored(type);
  const Handle space = space_of(shape);
  const Handle a =
      checked(H5Acreate2(impl_->here(), name, t.file, space.id(), H5P_DEFAULT, H5P_DEFAULT),
              H5Aclose, "H5Acreate");
  checked(H5Awrite(a.id(), t.memory, data), "H5Awrite");
}

void Hdf5Writer::text_attribute(const char* name, std::string& value) {
  const Handle type = text_type(value.size());
  const Handle space = space_of({});
  const Handle a =
      checked(H5Acreate2(impl_->here(), name, type.id(), space.id(), H5P_DEFAULT, H5P_DEFAULT),
              H5Aclose, "H5Acreate");
  // An empty text is one zero.
  checked(H5Awrite(a.id(), type.id(), value.empty() ? "" : value.data()), "H5Awrite");
}

void Hdf5Writer::dataset(const char* name, Type type, const Shape& shape, void* data) {
  const StoredType t = stored(type);
  const Handle space = space_of(shape);
  const Handle creation =
      impl_->dataset_creation(shape, elements(shape) * size_of(type), type == Type::kUInt8);
  const Handle d = checked(
      H5Dcreate2(impl_->here(), name, t.file, space.id(), H5P_DEFAULT, creation.id(), H5P_DEFAULT),
      H5Dclose, "H5Dcreate");
  if (elements(shape) == 0) return;
  checked(H5Dwrite(d.id(), t.memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, data), "H5Dwrite");
}

void Hdf5Writer::text_dataset(const char* name, std::vector<std::string>& values) {
  std::size_t length = 1;
  for (const std::string& v : values) length = std::max(length, std::min(v.size(), kLongest));
  std::string all(length * values.size(), '\0');
  for (std::size_t i = 0; i < values.size(); ++i) values[i].copy(&all[i * length], length);
  const Handle type = text_type(length);
  const Handle space = space_of({values.size()});
  const Handle creation = impl_->dataset_creation({values.size()}, all.size(), true);
  const Handle d = checked(H5Dcreate2(impl_->here(), name, type.id(), space.id(), H5P_DEFAULT,
                                      creation.id(), H5P_DEFAULT),
                           H5Dclose, "H5Dcreate");
  if (values.empty()) return;
  checked(H5Dwrite(d.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, all.data()), "H5Dwrite");
}

Archive::Shape Hdf5Writer::dataset_shape(const char*, std::size_t) { return {}; }

void Hdf5Writer::enter(const std::string& name) {
  impl_->groups.push_back(checked(
      H5Gcreate2(impl_->here(), name.c_str(), H5P_DEFAULT, impl_->group_creation.id(), H5P_DEFAULT),
      H5Gclose, "H5Gcreate"));
}

void Hdf5Writer::leave() { impl_->groups.pop_back(); }

bool Hdf5Writer::has_group(const std::string&) { return false; }

struct Hdf5Reader::Impl {
  Silence silence;
  std::size_t size = 0;  // of the file
  Handle file;
  std::vector<Handle> groups;
  std::vector<std::set<std::string>> asked{{}};  // of each group, the names asked for

  hid_t here() const { return groups.back().id(); }

  /// The first entry of the present group, attribute or other, that nobody has asked for and that
  /// is no note; "" if there is none.
  std::string unknown() const {
    struct Search {
      const std::set<std::string>& asked;
      std::string found{};
      herr_t take(const char* name) {
        if (std::string_view(name).starts_with("note") || asked.count(name) > 0) return 0;
        found = name;
        return 1;
      }
    } search{asked.back()};
    const auto attribute = [](hid_t, const char* name, const H5A_info_t*, void* to) -> herr_t {
      return static_cast<Search*>(to)->take(name);
    };
    const auto link = [](hid_t, const char* name, const H5L_info_t*, void* to) -> herr_t {
      return static_cast<Search*>(to)->take(name);
    };
    if (H5Aiterate2(here(), H5_INDEX_NAME, H5_ITER_INC, nullptr, attribute, &search) == 0) {
      H5Literate(here(), H5_INDEX_NAME, H5_ITER_INC, nullptr, link, &search);
    }
    return search.found;
  }

  /// Whether the present group has an entry of that name that is part of this file.
  bool has(const std::string& name) const {
    H5L_info_t link;
    return H5Lexists(here(), name.c_str(), H5P_DEFAULT) > 0 &&
           H5Lget_info(here(), name.c_str(), &link, H5P_DEFAULT) >= 0 && link.type == H5L_TYPE_HARD;
  }
};

Hdf5Reader::Hdf5Reader(std::string_view file) : impl_(std::make_unique<Impl>()) {
  constexpr std::string_view kSignature = "\x89HDF\r\n\x1a\n";
  if (file.substr(0, kSignature.size()) != kSignature) {
    throw std::invalid_argument("no HDF5 file; expected a problem file");
  }
  impl_->size = file.size();
  const Handle access = memory_access();
  // HDF5 takes the image as writable and copies it.
  checked(H5Pset_file_image(access.id(), const_cast<char*>(file.data()), file.size()),
          "H5Pset_file_image");
  end_in_silence();
  impl_->file = Handle(H5Fopen(unique_name().c_str(), H5F_ACC_RDONLY, access.id()), H5Fclose);
  if (impl_->file.valid()) {
    impl_->groups.emplace_back(H5Gopen2(impl_->file.id(), "/", H5P_DEFAULT), H5Gclose);
  }
  if (!impl_->file.valid() || !impl_->groups.back().valid()) {
    throw std::invalid_argument("damaged or truncated (" + last_error() +
                                "); expected a whole problem file");
  }
}

Hdf5Reader::~Hdf5Reader() = default;

void Hdf5Reader::attribute(const char* name, Type type, const Shape& shape, void* data) {
  impl_->asked.back().insert(name);
  const std::string expected = "an attribute of type " + describe(type, shape);
  const htri_t exists = H5Aexists(impl_->here(), name);
  if (exists == 0) refuse(name, "missing", expected);
  const Handle a(exists > 0 ? H5Aopen(impl_->here(), name, H5P_DEFAULT) : H5I_INVALID_HID,
                 H5Aclose);
  if (!a.valid()) refuse(name, "damaged (" + last_error() + ")", expected);
  const StoredType t = stored(type);
  const Handle its_type(H5Aget_type(a.id()), H5Tclose);
  const Handle its_space(H5Aget_space(a.id()), H5Sclose);
  const Handle space = space_of(shape);
  if (!its_type.valid() || !its_space.valid() || H5Tequal(its_type.id(), t.file) <= 0 ||
      H5Sextent_equal(its_space.id(), space.id()) <= 0) {
    refuse(name, "has another type or shape", expected);
  }
  if (H5Aread(a.id(), t.memory, data) < 0) {
    refuse(name, "damaged (" + last_error() + ")", expected);
  }
}

void Hdf5Reader::text_attribute(const char* name, std::string& value) {
  impl_->asked.back().insert(name);
  const std::string expected =
      "a text of a fixed length, at most " + std::to_string(kLongest) + " bytes";
  const htri_t exists = H5Aexists(impl_->here(), name);
  if (exists == 0) refuse(name, "missing", expected);
  const Handle a(exists > 0 ? H5Aopen(impl_->here(), name, H5P_DEFAULT) : H5I_INVALID_HID,
                 H5Aclose);
  if (!a.valid()) refuse(name, "damaged (" + last_error() + ")", expected);
  const Handle its_type(H5Aget_type(a.id()), H5Tclose);
  const Handle its_space(H5Aget_space(a.id()), H5Sclose);
  if (!its_type.valid() || !its_space.valid() || H5Tget_class(its_type.id()) != H5T_STRING ||
      H5Tis_variable_str(its_type.id()) != 0 ||
      H5Sget_simple_extent_type(its_space.id()) != H5S_SCALAR ||
      H5Tget_size(its_type.id()) > kLongest) {
    refuse(name, "has another type or shape", expected);
  }
  value.assign(H5Tget_size(its_type.id()), '\0');
  if (H5Aread(a.id(), its_type.id(), value.data()) < 0) {
    refuse(name, "damaged (" + last_error() + ")", expected);
  }
  value.resize(std::min(value.size(), value.find('\0')));
}

namespace {

/// A dataset of this file whose data can be read without surprise; else why not.
std::string trouble_with(hid_t dataset, std::size_t bytes, std::size_t file_size) {
  const Handle creation(H5Dget_create_plist(dataset), H5Pclose);
  if (!creation.valid()) return "damaged (" + last_error() + ")";
  const H5D_layout_t layout = H5Pget_layout(creation.id());
  if (layout != H5D_COMPACT && layout != H5D_CONTIGUOUS && layout != H5D_CHUNKED) {
    return "is stored in an unusual way";
  }
  if (H5Pget_external_count(creation.id()) != 0) return "lies in another file";
  // Of a contiguous one without data there is none, but its elements exist all the same.
  if (H5Dget_storage_size(dataset) > file_size) return "claims more data than the file has";
  if (layout == H5D_CHUNKED) {
    std::array<hsize_t, H5S_MAX_RANK> chunk{};
    const int rank = H5Pget_chunk(creation.id(), H5S_MAX_RANK, chunk.data());
    if (rank < 0) return "damaged (" + last_error() + ")";
    const Handle type(H5Dget_type(dataset), H5Tclose);
    double chunk_bytes = static_cast<double>(H5Tget_size(type.id()));
    for (int i = 0; i < rank; ++i)
      chunk_bytes *= static_cast<double>(chunk[static_cast<std::size_t>(i)]);
    if (chunk_bytes > static_cast<double>(std::max<std::size_t>(bytes, 1 << 20))) {
      return "has chunks larger than itself";
    }
  }
  const int filters = H5Pget_nfilters(creation.id());
  for (int i = 0; i < filters; ++i) {
    unsigned flags = 0;
    std::size_t values = 0;
    const H5Z_filter_t filter = H5Pget_filter2(creation.id(), static_cast<unsigned>(i), &flags,
                                               &values, nullptr, 0, nullptr, nullptr);
    if (filter != H5Z_FILTER_SHUFFLE && filter != H5Z_FILTER_DEFLATE &&
        filter != H5Z_FILTER_FLETCHER32) {
      return "has a filter other than shuffle, deflate and fletcher32";
    }
  }
  return "";
}

/// Extent of a dataset; empty if it has none.
Archive::Shape shape_of(hid_t dataset) {
  const Handle space(H5Dget_space(dataset), H5Sclose);
  std::array<hsize_t, H5S_MAX_RANK> dims{};
  if (!space.valid() || H5Sget_simple_extent_type(space.id()) != H5S_SIMPLE) return {};
  const int rank = H5Sget_simple_extent_dims(space.id(), dims.data(), nullptr);
  return rank < 0 ? Archive::Shape() : Archive::Shape(dims.begin(), dims.begin() + rank);
}

}  // namespace

Archive::Shape Hdf5Reader::dataset_shape(const char* name, std::size_t rank) {
  const std::string expected = "a dataset of " + std::to_string(rank) + " dimensions";
  if (!impl_->has(name)) refuse(name, "missing", expected);
  const Handle d(H5Dopen2(impl_->here(), name, H5P_DEFAULT), H5Dclose);
  if (!d.valid()) refuse(name, "damaged (" + last_error() + ")", expected);
  Shape shape = shape_of(d.id());
  if (shape.size() != rank) {
    refuse(name, "has " + std::to_string(shape.size()) + " dimensions", std::to_string(rank));
  }
  return shape;
}

void Hdf5Reader::dataset(const char* name, Type type, const Shape& shape, void* data) {
  impl_->asked.back().insert(name);
  const std::string expected = "a dataset of type " + describe(type, shape);
  if (!impl_->has(name)) refuse(name, "missing", expected);
  const Handle d(H5Dopen2(impl_->here(), name, H5P_DEFAULT), H5Dclose);
  if (!d.valid()) refuse(name, "damaged (" + last_error() + ")", expected);
  const StoredType t = stored(type);
  const Handle its_type(H5Dget_type(d.id()), H5Tclose);
  if (!its_type.valid() || H5Tequal(its_type.id(), t.file) <= 0 || shape_of(d.id()) != shape) {
    refuse(name, "has another type or shape", expected);
  }
  const std::string trouble = trouble_with(d.id(), elements(shape) * size_of(type), impl_->size);
  if (!trouble.empty()) refuse(name, trouble, expected + ", stored in this file");
  if (elements(shape) == 0) return;
  if (H5Dread(d.id(), t.memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, data) < 0) {
    refuse(name, "damaged (" + last_error() + ")", expected);
  }
}

void Hdf5Reader::text_dataset(const char* name, std::vector<std::string>& values) {
  impl_->asked.back().insert(name);
  const std::string expected = "a dataset of " + std::to_string(values.size()) +
                               " texts of a fixed length, at most " + std::to_string(kLongest) +
                               " bytes each";
  if (!impl_->has(name)) refuse(name, "missing", expected);
  const Handle d(H5Dopen2(impl_->here(), name, H5P_DEFAULT), H5Dclose);
  if (!d.valid()) refuse(name, "damaged (" + last_error() + ")", expected);
  const Handle type(H5Dget_type(d.id()), H5Tclose);
  if (!type.valid() || H5Tget_class(type.id()) != H5T_STRING ||
      H5Tis_variable_str(type.id()) != 0 || H5Tget_size(type.id()) > kLongest ||
      values.size() > kMostTexts || shape_of(d.id()) != Shape{values.size()}) {
    refuse(name, "has another type or shape", expected);
  }
  const std::size_t length = H5Tget_size(type.id());
  const std::string trouble = trouble_with(d.id(), length * values.size(), impl_->size);
  if (!trouble.empty()) refuse(name, trouble, expected + ", stored in this file");
  if (values.empty()) return;
  std::string all(length * values.size(), '\0');
  if (H5Dread(d.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, all.data()) < 0) {
    refuse(name, "damaged (" + last_error() + ")", expected);
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = all.substr(i * length, length);
    values[i].resize(std::min(values[i].size(), values[i].find('\0')));
  }
}

void Hdf5Reader::enter(const std::string& name) {
  if (!impl_->has(name)) refuse(name, "missing", "a group");
  Handle group(H5Gopen2(impl_->here(), name.c_str(), H5P_DEFAULT), H5Gclose);
  if (!group.valid()) refuse(name, "damaged (" + last_error() + ")", "a group");
  impl_->asked.back().insert(name);
  impl_->groups.push_back(std::move(group));
  impl_->asked.emplace_back();
}

void Hdf5Reader::finish() {
  const std::string unknown = impl_->unknown();
  if (!unknown.empty()) {
    constexpr std::size_t kShown = 60;
    refuse(unknown.substr(0, kShown), "not read",
           "what a problem of its version, model and shape has; notes are called note...");
  }
}

void Hdf5Reader::leave() {
  finish();
  impl_->groups.pop_back();
  impl_->asked.pop_back();
}

bool Hdf5Reader::has_group(const std::string& name) { return impl_->has(name); }

}  // namespace prospect
