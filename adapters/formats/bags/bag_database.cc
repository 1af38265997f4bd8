// The tables of rosbag2's SQLite files: topics(id, name, type, serialization_format),
// messages(id, topic_id, timestamp, data).

#ifdef PROSPECT_WITH_SQLITE
#include <sqlite3.h>
#endif

#include <map>
#include <memory>

#include "adapters/formats/bags/bag_file.h"
#include "adapters/formats/files/input_error.h"
#include "adapters/formats/files/not_built_in.h"

namespace prospect {

#ifdef PROSPECT_WITH_SQLITE

struct BagDatabase::Handle {
  sqlite3* database = nullptr;
  sqlite3_stmt* message = nullptr;
  ~Handle() {
    sqlite3_finalize(message);
    sqlite3_close(database);
  }
};

namespace {

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

}  // namespace

BagDatabase::BagDatabase(const std::string& path, std::size_t file, std::vector<BagTopic>& topics)
    : path_(path), handle_(std::make_shared<Handle>()) {
  if (sqlite3_open_v2(path.c_str(), &handle_->database, SQLITE_OPEN_READONLY, nullptr) !=
      SQLITE_OK) {
    throw InputError(path + ": " + sqlite3_errmsg(handle_->database) +
                     "; expected a database of rosbag2");
  }
  std::map<std::int64_t, std::string> names;
  run_query(handle_->database, path, "SELECT id, name, type, serialization_format FROM topics",
            [&](sqlite3_stmt* row) {
              const std::string name = column_text(row, 1);
              names[sqlite3_column_int64(row, 0)] = name;
              topic_named(topics, path, name, column_text(row, 2), column_text(row, 3));
            });
  run_query(handle_->database, path,
            "SELECT id, topic_id, timestamp, length(data) FROM messages ORDER BY timestamp, id",
            [&](sqlite3_stmt* row) {
              const auto name = names.find(sqlite3_column_int64(row, 1));
              if (name == names.end()) {
                throw InputError(path + ": a message of no topic; expected an intact database");
              }
              for (BagTopic& topic : topics) {
                if (topic.name != name->second) continue;
                topic.messages.push_back({sqlite3_column_int64(row, 2), file, 0,
                                          static_cast<std::size_t>(sqlite3_column_int64(row, 0)),
                                          static_cast<std::size_t>(sqlite3_column_int64(row, 3))});
              }
            });
  if (sqlite3_prepare_v2(handle_->database, "SELECT data FROM messages WHERE id = ?", -1,
                         &handle_->message, nullptr) != SQLITE_OK) {
    throw InputError(path + ": " + sqlite3_errmsg(handle_->database) +
                     "; expected a database of rosbag2");
  }
}

std::string BagDatabase::read(const BagTopic::Message& message) {
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
BagDatabase::BagDatabase(const std::string& path, std::size_t, std::vector<BagTopic>&) {
  throw NotBuiltIn(path + ": reading bags in SQLite", "libsqlite3-dev");
}
std::string BagDatabase::read(const BagTopic::Message&) { return {}; }

#endif

}  // namespace prospect
