// SPDX-License-Identifier: Apache-2.0
#ifdef PROSPECT_WITH_SQLITE

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <filesystem>
#include <string>

#include "adapters/formats/bags/bag_file.h"
#include "adapters/formats/files/input_error.h"

namespace prospect::bag_database_test {
namespace {

using ::testing::HasSubstr;

/// What opening a database, made by these statements, says; "" if it is read whole.
std::string said_of(const std::string& sql) {
  const std::string path = ::testing::TempDir() + "bag_database_test.db3";
  std::filesystem::remove(path);
  sqlite3* database = nullptr;
  EXPECT_EQ(sqlite3_open(path.c_str(), &database), SQLITE_OK);
  EXPECT_EQ(sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK)
      << sqlite3_errmsg(database);
  sqlite3_close(database);
  try {
    const BagFile bag = BagFile::open(path);
    for (const BagTopic& topic : bag.topics()) {
      for (const BagTopic::Message& message : topic.messages) bag.read(message);
    }
  } catch (const InputError& error) {
    EXPECT_EQ(error.lines().size(), 1u);
    return error.what();
  }
  return "";
}

const std::string kTopics =
    "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT);"
    "INSERT INTO topics VALUES(1, '/a', 'std_msgs/msg/Bool', 'cdr');";
const std::string kColumns = "(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, ";

TEST(BagDatabase, SqlOfAFileIsNotRun) {
  EXPECT_EQ(said_of(kTopics + "CREATE TABLE messages" + kColumns +
                    "data BLOB); INSERT INTO messages VALUES(7, 1, 5, x'0001');"),
            "");
  // A view that never ends, in either place.
  const std::string endless =
      " AS WITH RECURSIVE n(id) AS (SELECT 1 UNION ALL SELECT id + 1 FROM n) ";
  EXPECT_THAT(said_of(kTopics + "CREATE VIEW messages" + endless +
                      "SELECT id, 1 AS topic_id, id AS timestamp, zeroblob(9) AS data FROM n;"),
              HasSubstr("'messages' is no table"));
  EXPECT_THAT(said_of("CREATE VIEW topics" + endless +
                      "SELECT id, '/a' AS name, 'b' AS type, 'cdr' AS serialization_format FROM n;"
                      "CREATE TABLE messages" +
                      kColumns + "data BLOB);"),
              HasSubstr("'topics' is no table"));
  EXPECT_THAT(said_of(kTopics + "CREATE VIRTUAL TABLE messages USING fts4(topic_id, data);"),
              HasSubstr("'messages' is no table"));
  // A message that is longer than the file, by a column that is computed.
  EXPECT_NE(said_of(kTopics + "CREATE TABLE messages" + kColumns +
                    "data BLOB AS (zeroblob(900000000 + id))); INSERT INTO messages(id, topic_id, "
                    "timestamp) VALUES(7, 1, 5);"),
            "");
}

}  // namespace
}  // namespace prospect::bag_database_test

#endif
