// SPDX-License-Identifier: Apache-2.0
// The tables of rosbag2's SQLite files: topics(id, name, type, serialization_format),
// messages(id, topic_id, timestamp, data).

#ifdef PROSPECT_WITH_SQLITE
#include <sqlite3.h>
#endif

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <map>
#include <memory>
#include <string_view>
#include <utility>

#include "adapters/formats/bags/bag_file.h"
#include "adapters/formats/files/bounded_child.h"
#include "adapters/formats/files/input_error.h"
#include "adapters/formats/files/not_built_in.h"

namespace prospect {

#ifdef PROSPECT_WITH_SQLITE

namespace {

/// A database that is closed, with how many looks its statements may still take.
struct OpenDatabase {
  sqlite3* database = nullptr;
  sqlite3_stmt* message = nullptr;
  std::uintmax_t looks = 0;
  OpenDatabase() = default;
  ~OpenDatabase() {
    sqlite3_finalize(message);
    sqlite3_close(database);
  }
  OpenDatabase(const OpenDatabase&) = delete;
  OpenDatabase& operator=(const OpenDatabase&) = delete;
};

/// Runs a query; `row` reads each of its rows.
template <typename Row>
void run_query(sqlite3* database, const std::string& path, const char* sql, const Row& row) {
  sqlite3_stmt* made = nullptr;
  int result = sqlite3_prepare_v2(database, sql, -1, &made, nullptr);
  // `row` may throw, and a database with a query that goes on does not close.
  const std::unique_ptr<sqlite3_stmt, int (*)(sqlite3_stmt*)> statement(made, &sqlite3_finalize);
  while (result == SQLITE_OK || result == SQLITE_ROW) {
    result = sqlite3_step(statement.get());
    if (result != SQLITE_ROW) break;
    row(statement.get());
  }
  const std::string problem = sqlite3_errmsg(database);
  if (result != SQLITE_DONE) {
    throw InputError(path + ": " + problem + "; expected an intact database of rosbag2");
  }
}

std::string column_text(sqlite3_stmt* statement, int column) {
  const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(statement, column));
  return text != nullptr ? text : "";
}

/// Of two tables, as they are stored: nothing else that a file may ask for is done.
int allowed(void*, int action, const char* first, const char* second, const char*, const char*) {
  const auto is = [](const char* text, std::string_view word) {
    return text != nullptr && text == word;
  };
  if (action == SQLITE_SELECT) return SQLITE_OK;
  if (action == SQLITE_READ) {
    const bool known = is(first, "topics") || is(first, "messages") || is(first, "sqlite_master");
    return known ? SQLITE_OK : SQLITE_DENY;
  }
  return action == SQLITE_FUNCTION && is(second, "length") ? SQLITE_OK : SQLITE_DENY;
}

/// Opens a database whose schema is not trusted, with a bound on what a statement may do.
void open_untrusted(const BagPart& part, OpenDatabase& opened) {
  sqlite3*& database = opened.database;
  if (sqlite3_open_v2(part.path.c_str(), &database, SQLITE_OPEN_READONLY, nullptr) != SQLITE_OK) {
    throw InputError(part.name + ": " + sqlite3_errmsg(database) +
                     "; expected a database of rosbag2");
  }
  for (const auto& [setting, on] :
       {std::pair(SQLITE_DBCONFIG_DEFENSIVE, 1), std::pair(SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0),
        std::pair(SQLITE_DBCONFIG_ENABLE_VIEW, 0), std::pair(SQLITE_DBCONFIG_ENABLE_TRIGGER, 0)}) {
    sqlite3_db_config(database, setting, on, nullptr);
  }
  std::error_code error;
  const std::uintmax_t size =
      std::max<std::uintmax_t>(std::filesystem::file_size(part.path, error), 4096);
  sqlite3_limit(database, SQLITE_LIMIT_LENGTH,
                static_cast<int>(std::min<std::uintmax_t>(size, 1'000'000'000)));
  // A row of a table takes a byte of the file at least, and its reading some instructions.
  constexpr int kInstructions = 1 << 20;  // between two looks
  opened.looks = 100 + 20 * size / kInstructions;
  sqlite3_set_authorizer(database, &allowed, nullptr);
  sqlite3_progress_handler(
      database, kInstructions,
      [](void* left) {
        auto& looks = *static_cast<std::uintmax_t*>(left);
        return looks-- == 0 ? 1 : 0;
      },
      &opened.looks);
}

/// A list of rows, from the child: each a length of eight bytes, then its bytes.
void add_row(std::string& rows, std::string_view row) {
  const std::uint64_t size = row.size();
  rows.append(reinterpret_cast<const char*>(&size), sizeof size);
  rows += row;
}

std::string_view take_row(std::string_view& rows) {
  std::uint64_t size = 0;
  if (rows.size() >= sizeof size) std::memcpy(&size, rows.data(), sizeof size);
  rows.remove_prefix(std::min(rows.size(), sizeof size));
  const std::string_view row = rows.substr(0, static_cast<std::size_t>(size));
  rows.remove_prefix(row.size());
  return row;
}

/// What is in the list of a message; trivially copied.
struct MessageRow {
  std::int64_t topic = 0, id = 0, time = 0, size = 0;
};

/// Topics, each as id, name, type and encoding; an empty row; then the messages by their times.
std::string listed(const BagPart& part) {
  const std::string& path = part.name;
  OpenDatabase handle;
  open_untrusted(part, handle);
  std::string rows;
  // A view and a virtual table are SQL of the file.
  run_query(handle.database, path,
            "SELECT name, type, sql FROM sqlite_master WHERE name IN ('topics', 'messages')",
            [&](sqlite3_stmt* row) {
              const std::string sql = column_text(row, 2);
              if (column_text(row, 1) == "table" && sql.find("CREATE TABLE") == 0) return;
              throw InputError(path + ": '" + column_text(row, 0) +
                               "' is no table; expected an intact database of rosbag2");
            });
  run_query(handle.database, path, "SELECT id, name, type, serialization_format FROM topics",
            [&](sqlite3_stmt* row) {
              for (const int column : {0, 1, 2, 3}) add_row(rows, column_text(row, column));
            });
  add_row(rows, "");
  run_query(handle.database, path,
            "SELECT topic_id, rowid, timestamp, length(data) FROM messages "
            "ORDER BY timestamp, rowid",
            [&](sqlite3_stmt* row) {
              const MessageRow m{sqlite3_column_int64(row, 0), sqlite3_column_int64(row, 1),
                                 sqlite3_column_int64(row, 2), sqlite3_column_int64(row, 3)};
              rows.append(reinterpret_cast<const char*>(&m), sizeof m);
            });
  return rows;
}

}  // namespace

struct BagDatabase::Handle : OpenDatabase {};

BagDatabase::BagDatabase(const BagPart& part, std::vector<BagTopic>& topics)
    : path_(part.name), handle_(std::make_shared<Handle>()) {
  const std::string& path = path_;
  const std::size_t file = part.number;
  std::error_code error;
  const double size = static_cast<double>(std::filesystem::file_size(part.path, error));
  ChildLimits limits;
  limits.seconds = std::min(600.0, 20.0 + 1e-7 * size);
  const std::string all = run_in_child(
      path, [&] { return listed(part); }, limits);
  std::string_view rows = all;
  std::map<std::string, std::string> names;  // by the id of a topic
  for (std::string_view id = take_row(rows); !id.empty(); id = take_row(rows)) {
    const std::string name(take_row(rows)), type(take_row(rows)), encoding(take_row(rows));
    names[std::string(id)] = name;
    topic_named(topics, path, name, type, encoding);
  }
  std::map<std::int64_t, BagTopic*> by_id;
  for (const auto& [id, name] : names) {
    const auto found = std::find_if(topics.begin(), topics.end(),
                                    [&](const BagTopic& topic) { return topic.name == name; });
    by_id[std::strtoll(id.c_str(), nullptr, 10)] = &*found;
  }
  for (; rows.size() >= sizeof(MessageRow); rows.remove_prefix(sizeof(MessageRow))) {
    MessageRow m;
    std::memcpy(&m, rows.data(), sizeof m);
    const auto topic = by_id.find(m.topic);
    if (topic == by_id.end()) {
      throw InputError(path + ": a message of no topic; expected an intact database");
    }
    topic->second->messages.push_back(
        {m.time, file, 0, static_cast<std::size_t>(m.id), static_cast<std::size_t>(m.size)});
  }
  open_untrusted(part, *handle_);
  if (sqlite3_prepare_v2(handle_->database, "SELECT data FROM messages WHERE rowid = ?", -1,
                         &handle_->message, nullptr) != SQLITE_OK) {
    throw InputError(path + ": " + sqlite3_errmsg(handle_->database) +
                     "; expected a database of rosbag2");
  }
}

std::string BagDatabase::read(const BagTopic::Message& message) {
  handle_->looks = 100;
  sqlite3_stmt* statement = handle_->message;
  sqlite3_reset(statement);
  sqlite3_bind_int64(statement, 1, static_cast<std::int64_t>(message.begin));
  if (sqlite3_step(statement) != SQLITE_ROW) {
    throw InputError(path_ + ": cannot be read; expected it as it was");
  }
  const auto* data = static_cast<const char*>(sqlite3_column_blob(statement, 0));
  return data == nullptr
             ? std::string()
             : std::string(data, static_cast<std::size_t>(sqlite3_column_bytes(statement, 0)));
}

#else

struct BagDatabase::Handle {};
BagDatabase::BagDatabase(const BagPart& part, std::vector<BagTopic>&) {
  throw NotBuiltIn(part.name + ": reading bags in SQLite", "libsqlite3-dev");
}
std::string BagDatabase::read(const BagTopic::Message&) { return {}; }

#endif

}  // namespace prospect
