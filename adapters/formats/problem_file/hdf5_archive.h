// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "adapters/formats/problem_file/archive.h"

namespace prospect {

/// Archives that are HDF5 files in memory: HDF5 itself touches no file. While one is alive HDF5
/// prints no error messages in this thread; what it has to say is in the exceptions.
///
/// Written in the format of HDF5 1.10, in which all metadata carry checksums; attributes are part
/// of them. Datasets are compressed and have checksums of their own (fletcher32). No times are
/// stored: the same content gives the same bytes.
class Hdf5Writer final : public Archive {
 public:
  Hdf5Writer();
  ~Hdf5Writer() override;
  bool writing() const override { return true; }
  /// The file. Nothing can be written after it.
  std::string finish();

 private:
  void attribute(const char* name, Type type, const Shape& shape, void* data) override;
  void text_attribute(const char* name, std::string& value) override;
  void dataset(const char* name, Type type, const Shape& shape, void* data) override;
  void text_dataset(const char* name, std::vector<std::string>& values) override;
  Shape dataset_shape(const char* name, std::size_t rank) override;
  void enter(const std::string& name) override;
  void leave() override;
  bool has_group(const std::string& name) override;

  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Takes nothing on trust: an entry must have the very type and shape that is asked for before
/// anything is read or allocated, its data must lie in this file (no external files, no links to
/// elsewhere, no filters but the usual), and checksums must hold. An entry that nobody has asked
/// for when its group is left is refused, but for notes: what is called note... (Against accidents:
/// HDF5 inflates a crafted chunk before it compares sizes.)
class Hdf5Reader final : public Archive {
 public:
  /// `file` need not outlive the constructor. Throws std::invalid_argument if it is no HDF5 file.
  explicit Hdf5Reader(std::string_view file);
  ~Hdf5Reader() override;
  bool writing() const override { return false; }
  /// Nothing is asked for after it: looks through what is left at the root.
  void finish();

 private:
  void attribute(const char* name, Type type, const Shape& shape, void* data) override;
  void text_attribute(const char* name, std::string& value) override;
  void dataset(const char* name, Type type, const Shape& shape, void* data) override;
  void text_dataset(const char* name, std::vector<std::string>& values) override;
  Shape dataset_shape(const char* name, std::size_t rank) override;
  void enter(const std::string& name) override;
  void leave() override;
  bool has_group(const std::string& name) override;

  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace prospect
