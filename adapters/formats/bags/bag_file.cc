#include "adapters/formats/bags/bag_file.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <utility>

#include "adapters/formats/files/input_error.h"

namespace prospect {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> bag_files(const std::string& path) {
  std::error_code error;
  std::vector<std::string> files;
  const auto is_file = [](const fs::path& name) {
    return name.extension() == ".mcap" || name.extension() == ".db3";
  };
  if (fs::is_directory(path, error)) {
    for (const auto& entry : fs::directory_iterator(path, error)) {
      if (is_file(entry.path()) && entry.path().filename().string()[0] != '.') {
        files.push_back(entry.path().string());
      }
    }
    std::sort(files.begin(), files.end());
  } else if (is_file(path) && fs::is_regular_file(path, error)) {
    files.push_back(path);
  }
  return files;
}

}  // namespace

struct BagFile::Impl {
  struct File {
    std::optional<McapFile> mcap;
    std::optional<BagDatabase> database;
  };
  std::vector<File> files;
  std::vector<BagTopic> topics;
  std::vector<std::string> notes;
};

bool is_bag(const std::string& path) { return !bag_files(path).empty(); }

BagFile BagFile::open(const std::string& path) {
  BagFile bag;
  bag.impl_ = std::make_shared<Impl>();
  Impl& impl = *bag.impl_;
  const std::vector<std::string> files = bag_files(path);
  if (files.empty()) throw InputError(path + ": no bag; expected a .mcap or .db3 file");
  for (const std::string& file : files) {
    Impl::File opened;
    if (file.ends_with(".mcap")) {
      opened.mcap.emplace(file, impl.files.size(), impl.topics, impl.notes);
    } else {
      opened.database.emplace(file, impl.files.size(), impl.topics);
    }
    impl.files.push_back(std::move(opened));
  }
  std::size_t messages = 0;
  for (BagTopic& topic : impl.topics) {
    std::stable_sort(
        topic.messages.begin(), topic.messages.end(),
        [](const BagTopic::Message& a, const BagTopic::Message& b) { return a.time < b.time; });
    messages += topic.messages.size();
  }
  if (messages == 0) throw InputError(path + ": holds no message; expected a recording");
  return bag;
}

const std::vector<BagTopic>& BagFile::topics() const { return impl_->topics; }
const std::vector<std::string>& BagFile::notes() const { return impl_->notes; }

const BagTopic* BagFile::find(const std::string& name) const {
  for (const BagTopic& topic : impl_->topics) {
    if (topic.name == name) return &topic;
  }
  return nullptr;
}

const BagFile::Fields* BagFile::metadata(const std::string& name) const {
  for (auto file = impl_->files.rbegin(); file != impl_->files.rend(); ++file) {
    if (!file->mcap) continue;
    const auto found = file->mcap->metadata().find(name);
    if (found != file->mcap->metadata().end()) return &found->second;
  }
  return nullptr;
}

std::string BagFile::read(const BagTopic::Message& message) const {
  Impl::File& file = impl_->files[message.file];
  return file.mcap ? file.mcap->read(message) : file.database->read(message);
}

BagTopic& topic_named(std::vector<BagTopic>& topics, const std::string& path,
                      const std::string& name, const std::string& type,
                      const std::string& encoding) {
  for (BagTopic& topic : topics) {
    if (topic.name != name) continue;
    if (topic.type != type) {
      throw InputError(path + ": topic " + name + " has the types " + topic.type + " and " + type +
                       "; expected one");
    }
    return topic;
  }
  topics.push_back({name, type, encoding, {}});
  return topics.back();
}

}  // namespace prospect
