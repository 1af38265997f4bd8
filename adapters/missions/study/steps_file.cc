// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/study/steps_file.h"

#include <hdf5.h>

#include <filesystem>
#include <set>
#include <system_error>
#include <utility>

#include "adapters/formats/files/input_error.h"
#include "adapters/missions/run/step_fields.h"
#include "adapters/views/report/step_table.h"

namespace prospect {
namespace {

/// An identifier of the library, closed at the end. Throws InputError if it is none.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t), const std::string& what) : id_(id), close_(close) {
    if (id < 0) throw InputError(what + ": cannot be written; expected room on the disk");
  }
  ~Handle() { close_(id_); }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  operator hid_t() const { return id_; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

void check(herr_t result, const std::string& what) {
  if (result < 0) throw InputError(what + ": cannot be written; expected room on the disk");
}

/// Writes one run.
class RunWriter {
 public:
  RunWriter(hid_t group, std::string what)
      : group_(group), what_(std::move(what)), text_(H5Tcopy(H5T_C_S1), H5Tclose, what_) {
    check(H5Tset_size(text_, H5T_VARIABLE), what_);
    check(H5Tset_cset(text_, H5T_CSET_UTF8), what_);
  }

  void attribute(const char* name, const std::string& value) {
    const Handle space(H5Screate(H5S_SCALAR), H5Sclose, what_);
    const Handle entry(H5Acreate2(group_, name, text_, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
                       what_);
    const char* text = value.c_str();
    check(H5Awrite(entry, text_, &text), what_);
  }
  void attribute(const char* name, std::uint64_t value) {
    const Handle space(H5Screate(H5S_SCALAR), H5Sclose, what_);
    const Handle entry(H5Acreate2(group_, name, H5T_STD_U64LE, space, H5P_DEFAULT, H5P_DEFAULT),
                       H5Aclose, what_);
    check(H5Awrite(entry, H5T_NATIVE_UINT64, &value), what_);
  }
  void column(const std::string& name, const std::vector<double>& values) {
    dataset(name, values.size(), H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, values.data());
  }
  void column(const std::string& name, const std::vector<std::string>& values) {
    std::vector<const char*> texts;
    for (const std::string& value : values) texts.push_back(value.c_str());
    dataset(name, texts.size(), text_, text_, texts.data());
  }

 private:
  void dataset(const std::string& name, std::size_t size, hid_t stored, hid_t memory,
               const void* data) {
    const hsize_t rows = size;
    const Handle space(H5Screate_simple(1, &rows, nullptr), H5Sclose, what_);
    const Handle entry(
        H5Dcreate2(group_, name.c_str(), stored, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
        H5Dclose, what_);
    if (size > 0) check(H5Dwrite(entry, memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, data), what_);
  }

  hid_t group_;
  std::string what_;
  Handle text_;
};

}  // namespace

void write_steps(const StudyPlan& plan, const CellStore& store, const std::vector<StudyRow>& rows,
                 const std::string& path) {
  const std::string part = path + ".part";
  {
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // its own messages are many lines
    const Handle file(H5Fcreate(part.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose,
                      path);
    std::set<std::string> written;
    for (const StudyRow& row : rows) {
      const StudyCell& cell = *row.cell;
      if (row.record.status != CellRecord::Status::kDone || !written.insert(row.id).second) {
        continue;
      }
      const StepTable table = StepTable::read(store.run_folder(row.id) + "/steps.csv");
      const Handle group(H5Gcreate2(file, row.id.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                         H5Gclose, path);
      RunWriter writer(group, path);
      writer.attribute("condition", plan.condition(plan.setup(cell)).name);
      writer.attribute("world", plan.study.inputs[cell.input].name);
      writer.attribute("label", plan.label(plan.setup(cell)));
      writer.attribute("seed", cell.seed);
      for (const std::string& column : table.columns()) {
        // A column that this program does not know is of another version.
        const StepField* field = field_of_column(column).first;
        if (!field || field->holds_text()) {
          writer.column(column, table.words(column));
        } else {
          writer.column(column, table.numbers(column));
        }
      }
    }
    check(H5Fflush(file, H5F_SCOPE_GLOBAL), path);
  }
  std::error_code error;
  std::filesystem::rename(part, path, error);
  if (error)
    throw InputError(path + ": cannot be written (" + error.message() +
                     "); expected a writable folder");
}

}  // namespace prospect
