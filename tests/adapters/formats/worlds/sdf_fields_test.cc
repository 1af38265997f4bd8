// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/worlds/sdf_fields.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/worlds/gazebo_world.h"
#include "tests/adapters/formats/field_outcomes.h"
#include "tests/adapters/mesh_files.h"

namespace prospect::sdf_fields_test {
namespace {

/// What sdformat's descriptions of SDF 1.4 to 1.12 have (sdf/1.*/*.sdf), an element or attribute by
/// what holds it; what holds models of a <state> by its name of today.
const char* const kSpecification = R"(
sdf@version sdf/world sdf/model sdf/light sdf/actor
world@name world/audio world/wind world/include world/gravity world/magnetic_field world/atmosphere
world/gui world/physics world/scene world/light world/frame world/model world/joint world/actor
world/plugin world/road world/spherical_coordinates world/state world/population
include@merge include/uri include/name include/static include/pose include/plugin include/namespace
include/placement_frame include/model_state
model@name model@canonical_link model@placement_frame model@namespace model/static model/model
model/self_collide model/allow_auto_disable model/include model/enable_wind model/frame model/pose
model/link model/joint model/plugin model/gripper model/model_state
frame@name frame@attached_to frame/pose
pose@frame pose@relative_to pose@rotation_format pose@degrees
joint@name joint@type joint/parent joint/child joint/gearbox_ratio joint/gearbox_reference_body
joint/thread_pitch joint/screw_thread_pitch joint/axis joint/axis2 joint/physics joint/pose
joint/sensor
link@name link/gravity link/enable_wind link/self_collide link/kinematic link/must_be_base_link
link/velocity_decay link/frame link/pose link/inertial link/collision link/visual link/sensor
link/projector link/audio_source link/audio_sink link/battery link/light link/particle_emitter
visual@name visual/cast_shadows visual/laser_retro visual/transparency visual/visibility_flags
visual/meta visual/frame visual/pose visual/material visual/geometry visual/plugin
material/script material/shader material/lighting material/ambient material/diffuse
material/specular material/emissive material/shininess material/render_order material/double_sided
material/pbr
geometry/empty geometry/box geometry/capsule geometry/cone geometry/cylinder geometry/ellipsoid
geometry/heightmap geometry/image geometry/mesh geometry/plane geometry/polyline geometry/sphere
box/size capsule/radius capsule/length cone/radius cone/length cylinder/radius cylinder/length
ellipsoid/radii mesh/uri mesh/submesh mesh/scale mesh/convex_decomposition mesh@optimization
submesh/name submesh/center plane/normal plane/size polyline/point polyline/height sphere/radius
state@world_name state/sim_time state/wall_time state/real_time state/iterations state/insertions
state/deletions state/model state/model_state state/light state/light_state state/joint_state
insertions/model insertions/light insertions/joint deletions/name
model_state@name model_state/joint model_state/joint_state model_state/model model_state/model_state
model_state/pose model_state/frame model_state/scale model_state/link model_state/link_state
link_state@name link_state/velocity link_state/linear_velocity link_state/angular_velocity
link_state/acceleration link_state/linear_acceleration link_state/angular_acceleration
link_state/wrench link_state/force link_state/torque link_state/collision link_state/collision_state
link_state/pose
)";

/// A world in which each field of the table can be told.
const char* const kWorld = R"(<?xml version='1.0'?>
<sdf version='1.6'>
<world name='w'>
<gravity>0 0 -9.8</gravity>
<physics type='ode'><gravity>0 0 -9</gravity></physics>
<frame name='far' attached_to='door'><pose>0 0 1 0 0 0</pose></frame>
<model name='stone'><pose frame='near'>0 0 1 0 0 0</pose><link name='l'><visual name='v'><geometry>
<sphere><radius>0.3</radius></sphere></geometry></visual></link></model>
<model name='pillar'><pose relative_to='shed'>0 0 1 0 0 0</pose><link name='l'><visual name='v'>
<geometry><sphere><radius>0.4</radius></sphere></geometry></visual></link></model>
<frame name='near'><pose>1 2 3 0 0 0</pose></frame>
<include merge='true'><name>shed</name><uri>model://shed</uri><pose>7 0 0 0 0 0</pose>
<placement_frame>door</placement_frame></include>
<model name='hall' placement_frame='gate'><pose relative_to='far'>1 0 0 0 0 0.5</pose>
<frame name='gate'><pose>2 0 0 0 0 0</pose></frame>
<frame name='hook' attached_to='hinge'/>
<joint name='hinge' type='fixed'><child>wall</child><pose>0 5 0 0 0 0</pose></joint>
<model name='annex'><link name='side'><visual name='v'><geometry><sphere><radius>1</radius></sphere>
</geometry></visual></link></model>
<include><uri>model://post</uri></include>
<link name='wall'><pose>0 1 0 0 0 0</pose><visual name='v'><pose degrees='0'>0 0 2 0 0 1</pose>
<geometry><box><size>1 2 3</size></box></geometry><transparency>0</transparency>
<visibility_flags>4294967295</visibility_flags>
<material><ambient>0.5 0.5 0.5 1</ambient></material></visual></link>
<link name='rail'><pose relative_to='hook'/>
<visual name='a'><geometry><capsule><radius>1</radius><length>2</length></capsule></geometry>
<material><diffuse>0.2 0.5 0.5 1</diffuse></material></visual>
<visual name='b'><geometry><cone><radius>1</radius><length>2</length></cone></geometry></visual>
<visual name='c'><geometry><cylinder><radius>1</radius><length>2</length></cylinder></geometry></visual>
<visual name='d'><geometry><ellipsoid><radii>1 2 3</radii></ellipsoid></geometry></visual>
<visual name='e'><geometry><plane><normal>0 0 1</normal><size>1 2</size></plane></geometry></visual>
<visual name='f'><geometry><polyline><point>0 0</point><point>1 0</point><point>0 1</point>
<height>1</height></polyline></geometry></visual>
<visual name='h'><pose rotation_format='euler_rpy'>0 0 0 0 0 1</pose><geometry><empty/></geometry></visual>
</link></model>
<model name='cart'><pose>1 1 0 0 0 0</pose>
<model name='load'><link name='l'><visual name='v'><geometry><sphere><radius>0.5</radius></sphere>
</geometry></visual></link></model>
<link name='bed'><visual name='v'><geometry><box><size>3 1 1</size></box></geometry></visual></link>
<link name='rim'><visual name='v'><geometry><box><size>3 1 2</size></box></geometry></visual></link>
</model>
<model name='gone'><link name='l'><visual name='v'><geometry><sphere><radius>9</radius></sphere>
</geometry></visual></link></model>
<state world_name='w'><deletions><name>gone</name></deletions>
<insertions><model name='new'><link name='l'><visual name='v'><geometry><sphere><radius>2</radius>
</sphere></geometry></visual></link></model></insertions>
<model name='cart'><pose>4 4 0 0 0 0</pose><scale>1 1 1</scale>
<model name='load'><pose>9 9 0 0 0 0</pose></model>
<link name='rim'><pose>5 5 0 0 0 0</pose></link></model></state>
</world></sdf>
)";

/// One with a mesh, which takes longer to read.
const char* const kMeshWorld = R"(<?xml version='1.0'?>
<sdf version='1.6'><model name='m'><link name='l'><visual name='g'><geometry>
<mesh><uri>two.obj</uri><scale>1 1 1</scale><submesh><name>low</name><center>0</center></submesh>
</mesh></geometry></visual></link></model></sdf>
)";

bool is_of_a_mesh(const std::string& field) { return field.find("mesh") != std::string::npos; }

struct Change {
  std::string from, to;
};

/// How the world is changed to hold a field, or other words in it: one with each change.
std::map<std::string, std::vector<Change>> changes() {
  std::map<std::string, std::vector<Change>> all;
  const auto words = [&](const char* field, const std::string& from, const std::string& to) {
    all[field].push_back({from, to});
  };
  // An element of no further meaning within another.
  const auto element = [&](const std::string& within, const std::vector<std::string>& names,
                           const std::string& before) {
    for (const std::string& name : names) {
      all[within + "/" + name].push_back({before, "<" + name + ">1</" + name + ">" + before});
    }
  };
  words("sdf@version", "version='1.6'", "version='1.2'");
  words("sdf@version", "version='1.6'", "version='2.0'");
  element("sdf", {"light", "actor"}, "</sdf>");
  words("sdf/world", "<world name='w'>", "<old><world name='w'>");
  words("sdf/model", "<world name='w'>", "<model name='m'/><world name='w'>");
  words("sdf/include", "<world name='w'>", "<include/><world name='w'>");
  words("world@name", "<world name='w'>", "<world name='x'>");
  const std::string in_world = "<gravity>0 0 -9.8";
  element("world",
          {"actor", "atmosphere", "audio", "gui", "joint", "light", "magnetic_field", "plugin",
           "population", "road", "scene", "spherical_coordinates", "wind"},
          in_world);
  words("world/physics", "type='ode'>", "type='ode'><max_step_size>1</max_step_size>");
  words("world/gravity", "-9.8", "9.8");
  words("world/gravity", "0 0 -9.8", "0 -9.8 0");
  words("physics/gravity", "0 0 -9<", "0 0 9<");
  words("world/frame", "<pose>1 2 3", "<pose>1 2 4");
  words("world/include", "<uri>model://shed", "<uri>model://post");
  words("world/model", "<model name='gone'>", "<model name='kept'>");
  words("world/state", "<state", "<state/><state");
  all["world/state"] = {{"<pose>4 4 0", "<pose>4 5 0"}};
  words("frame@name", "name='gate'", "name='gat'");
  words("frame@attached_to", " attached_to='hinge'", "");
  words("frame/pose", "2 0 0 0 0 0", "2 1 0 0 0 0");
  words("include@merge", " merge='true'", "");
  words("include/name", "<name>shed", "<name>hut");
  words("include/uri", "model://post", "model://shed");
  words("include/pose", "7 0 0", "8 0 0");
  words("include/placement_frame", "<placement_frame>door</placement_frame>", "");
  element("include", {"model_state", "namespace", "plugin", "static"}, "<name>shed");
  words("model@name", "<model name='load'><link", "<model name='cargo'><link");
  words("model@placement_frame", " placement_frame='gate'", "");
  words("model@canonical_link", "'hall'", "'hall' canonical_link='rail'");
  words("model@namespace", "'hall'", "'hall' namespace='h'");
  element("model",
          {"allow_auto_disable", "enable_wind", "gripper", "model_state", "plugin", "self_collide",
           "static"},
          "<frame name='gate'>");
  words("model/frame", "<frame name='hook' attached_to='hinge'/>", "");
  words("model/include", "<include><uri>model://post</uri></include>", "");
  words("model/joint", "<joint name", "<joint title");
  words("model/link", "<link name='wall'>", "<link name='wall'/><link name='other'>");
  words("model/model", "<sphere><radius>1<", "<sphere><radius>1.5<");
  words("model/pose", "1 0 0 0 0 0.5", "1 0 0 0 0 0.6");
  words("joint@name", "name='hinge'", "name='pivot'");
  words("joint@type", "type='fixed'", "type='revolute'");
  words("joint/child", "<child>wall", "<child>rai");
  words("joint/pose", "0 5 0", "0 6 0");
  element("joint",
          {"axis", "axis2", "gearbox_ratio", "gearbox_reference_body", "parent", "physics",
           "screw_thread_pitch", "thread_pitch", "sensor"},
          "<child>wall");
  words("link@name", "<link name='wall'>", "<link name='wal'>");
  words("link/pose", "<pose>0 1 0", "<pose>0 2 0");
  words("link/visual", "<size>1 2 3", "<size>1 2 4");
  element("link",
          {"audio_sink", "audio_source", "battery", "enable_wind", "frame", "gravity", "inertial",
           "kinematic", "light", "must_be_base_link", "particle_emitter", "projector",
           "self_collide", "sensor", "velocity_decay"},
          "<visual name='a'>");
  words("link/collision", "<visual name='a'>",
        "<collision name='c'><geometry><box><size>9 9 9</size></box></geometry></collision>"
        "<visual name='a'>");
  words("visual@name", "name='a'", "name='z'");
  words("visual/pose", "0 0 2 0 0 1", "0 0 2 0 0 2");
  words("visual/geometry", "<geometry><cone>", "<geometry/><geometry><cone>");
  words("visual/material", "<material><ambient>", "<other><ambient>");
  all["visual/material"] = {{"<material><ambient>0.5 0.5 0.5 1</ambient></material>", ""}};
  words("visual/transparency", "<transparency>0<", "<transparency>0.5<");
  words("visual/visibility_flags", ">4294967295<", ">0<");
  element("visual", {"cast_shadows", "frame", "laser_retro", "meta", "plugin"}, "<transparency>");
  words("material/ambient", "<ambient>0.5", "<ambient>0.9");
  words("material/diffuse", "<diffuse>0.2", "<diffuse>0.9");
  element("material",
          {"double_sided", "emissive", "lighting", "pbr", "render_order", "script", "shader",
           "shininess", "specular"},
          "<ambient>");
  for (const char* shape :
       {"box", "capsule", "cone", "cylinder", "ellipsoid", "mesh", "plane", "polyline", "sphere"}) {
    const std::string name = shape;
    words(("geometry/" + name).c_str(), "<" + name + ">", "<empty/><" + name + ">");
  }
  words("geometry/empty", "<empty/>", "<sphere><radius>3</radius></sphere>");
  words("geometry/heightmap", "<empty/>", "<heightmap/>");
  words("geometry/image", "<empty/>", "<image/>");
  words("box/size", "<size>1 2 3", "<size>2 2 3");
  for (const char* shape : {"capsule", "cone", "cylinder"}) {
    const std::string name = shape, begin = "<" + name + ">";
    words((name + "/radius").c_str(), begin + "<radius>1", begin + "<radius>1.5");
    words((name + "/length").c_str(), begin + "<radius>1</radius><length>2",
          begin + "<radius>1</radius><length>3");
  }
  words("ellipsoid/radii", "1 2 3</radii>", "1 2 4</radii>");
  words("sphere/radius", "<sphere><radius>1<", "<sphere><radius>2<");
  words("plane/normal", "0 0 1</normal>", "1 0 0</normal>");
  words("plane/size", "1 2</size>", "2 2</size>");
  words("polyline/point", "<point>1 0", "<point>2 0");
  words("polyline/height", "<height>1", "<height>2");
  words("mesh/uri", "two.obj", "one.obj");
  words("mesh/scale", "<scale>1 1 1", "<scale>1 2 1");
  words("mesh/submesh", "<submesh><name>low</name><center>0</center></submesh>", "");
  words("mesh@optimization", "<mesh>", "<mesh optimization='convex_hull'>");
  element("mesh", {"convex_decomposition"}, "<uri>two.obj");
  words("submesh/name", "<name>low", "<name>high");
  words("submesh/center", "<center>0", "<center>1");
  words("pose@frame", " frame='near'", "");
  words("pose@relative_to", " relative_to='far'", "");
  words("pose@degrees", "degrees='0'", "degrees='1'");
  words("pose@rotation_format", "'euler_rpy'>0 0 0 0 0 1</pose><geometry><empty/>",
        "'quat_xyzw'>1 0 0 0 0 0 1</pose><geometry><sphere><radius>1</radius></sphere>");
  words("state@world_name", "world_name='w'", "world_name='x'");
  element(
      "state",
      {"iterations", "joint_state", "light", "light_state", "real_time", "sim_time", "wall_time"},
      "<deletions>");
  words("state/deletions", "<deletions><name>gone</name></deletions>", "");
  words("state/insertions", "<radius>2</radius>\n</sphere>", "<radius>3</radius>\n</sphere>");
  words("state/model", "<pose>4 4 0", "<pose>4 4 1");
  words("state/model_state", "</state>",
        "<model_state name='new'><pose>8 8 8 0 0 0</pose></model_state></state>");
  words("insertions/model", "<insertions><model name='new'>", "<insertions><model name='hall'>");
  all["insertions/model"] = {{"<radius>2</radius>\n</sphere>", "<radius>4</radius>\n</sphere>"}};
  element("insertions", {"joint", "light"}, "<model name='new'>");
  words("deletions/name", "<name>gone", "<name>hall");
  words("model_state@name", "<model name='cart'><pose>4", "<model name='new'><pose>4");
  words("model_state/pose", "<pose>4 4 0", "<pose>4 6 0");
  words("model_state/scale", "<scale>1 1 1</scale>\n<model", "<scale>1 1 2</scale>\n<model");
  words("model_state/scale", "9 9 0 0 0 0</pose>", "9 9 0 0 0 0</pose><scale>2 2 2</scale>");
  words("model_state/model", "9 9 0", "9 9 1");
  words("model_state/model_state", "</model></state>",
        "<model_state name='load'><pose>9 9 2 0 0 0</pose></model_state></model></state>");
  words("model_state/link", "5 5 0", "5 5 1");
  words("model_state/link_state", "</model></state>",
        "<link_state name='rim'><pose>5 5 2 0 0 0</pose></link_state></model></state>");
  element("model_state", {"frame", "joint", "joint_state"}, "<scale>1 1 1</scale>\n<model");
  words("link_state@name", "<link name='rim'><pose>5", "<link name='bed'><pose>5");
  words("link_state/pose", "5 5 0", "5 6 0");
  element(
      "link_state",
      {"acceleration", "angular_acceleration", "angular_velocity", "collision", "collision_state",
       "force", "linear_acceleration", "linear_velocity", "torque", "velocity", "wrench"},
      "<pose>5 5 0");
  return all;
}

class SdfFields : public ::testing::Test {
 protected:
  SdfFields() : folder_("sdf fields") {
    const std::string post =
        "<link name='l'><visual name='v'><geometry><cylinder><radius>0.1</radius><length>3</length>"
        "</cylinder></geometry></visual></link>";
    folder_.write("shed/model.sdf",
                  "<sdf version='1.6'><model name='hut'><frame name='door'><pose>3 0 0 0 0 0</pose>"
                  "</frame><link name='l'><visual name='v'><geometry><box><size>2 2 2</size></box>"
                  "</geometry></visual></link></model></sdf>");
    folder_.write("post/model.sdf",
                  "<sdf version='1.6'><model name='post'>" + post + "</model></sdf>");
    const std::string corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 9\nv 1 0 9\nv 0 1 9\n";
    folder_.write("two.obj", corners + "o low\nf 1 2 3\no high\nf 4 5 6\n");
    folder_.write("one.obj", corners + "o low\nf 1 2 6\n");
  }

  /// What is read of a world, and what is left out.
  std::pair<std::string, std::string> outcome(const std::string& world) const {
    try {
      const TexturedMesh mesh = read_gazebo_world(folder_.write("w.world", world));
      std::ostringstream out;
      for (const Eigen::Vector3f& v : mesh.vertices) out << v.transpose() << '\n';
      for (std::size_t n = 0; n < mesh.triangles.size(); ++n) {
        const auto& [a, b, c] = mesh.triangles[n];
        out << a << ' ' << b << ' ' << c << ' ' << +mesh.textures[mesh.material[n]].at(0, 0)
            << '\n';
      }
      return {out.str(), mesh.left_out.text()};
    } catch (const InputError& error) {
      return {std::string("refused: ") + error.what(), ""};
    }
  }

  const test::Folder folder_;
};

TEST_F(SdfFields, EachIsWhatTheTableSays) {
  std::map<bool, std::string> sound;  // by whether it is the world with a mesh
  for (const bool mesh : {false, true}) {
    const auto [read, left_out] = outcome(mesh ? kMeshWorld : kWorld);
    ASSERT_FALSE(read.starts_with("refused")) << read;
    ASSERT_EQ(left_out, "");
    sound[mesh] = read;
  }
  const auto all = changes();
  for (const FieldRule& rule : sdf_fields()) {
    SCOPED_TRACE(rule.name);
    EXPECT_EQ(std::strlen(rule.why) > 0, rule.use == FieldUse::kNotNeeded);
    ASSERT_TRUE(all.contains(rule.name));
    const std::string& before = sound.at(is_of_a_mesh(rule.name));
    for (const auto& [from, to] : all.at(rule.name)) {
      std::string world = is_of_a_mesh(rule.name) ? kMeshWorld : kWorld;
      const std::size_t at = world.find(from);
      ASSERT_NE(at, std::string::npos) << from;
      world.replace(at, from.size(), to);
      const auto [after, told] = outcome(world);
      const bool refused = after.starts_with("refused");
      switch (rule.use) {
        case FieldUse::kUsed:
          EXPECT_FALSE(after + told == before) << to;
          break;
        case FieldUse::kChecked:
          EXPECT_TRUE(refused) << to;
          break;
        case FieldUse::kRefused:
          EXPECT_TRUE(refused || !told.empty()) << to;
          break;
        case FieldUse::kNotNeeded:
          EXPECT_TRUE(after == before) << to;
          EXPECT_EQ(told, "") << to;
      }
    }
  }
  EXPECT_EQ(all.size(), sdf_fields().size());
}

TEST_F(SdfFields, AreAllOfTheSpecificationAndWhatIsNotIsTold) {
  std::istringstream names(kSpecification);
  std::set<std::string> specified{"sdf/include", "physics/gravity"};  // what Gazebo takes, too
  for (std::string name; names >> name;) EXPECT_TRUE(specified.insert(name).second) << name;
  std::set<std::string> listed;
  for (const FieldRule& rule : sdf_fields()) listed.insert(rule.name);
  EXPECT_EQ(listed, specified);
  // Whatever the reader asks an element for.
  for (const std::string& name :
       test::keys_asked_for("adapters/formats/worlds/gazebo_world.cc",
                            R"re((?:FirstChild|NextSibling)Element\("(\w+)"\))re")) {
    const bool known = std::any_of(listed.begin(), listed.end(), [&](const std::string& field) {
      return field.ends_with("/" + name);
    });
    EXPECT_TRUE(known || name == "sdf") << name;
  }
  for (const auto& [from, to, words] : std::vector<std::array<std::string, 3>>{
           {"<visual name='a'>", "<visual name='a'><glow/>", "1 'glow' element"},
           {"<link name='rail'>", "<link name='rail' scale='2'>", "1 'scale' attribute"},
           {"<size>1 2 3</size>", "<size>1 2 3</size><bevel/>", "1 'bevel' element"},
           {"<name>shed", "<experimental:params/><name>shed", "1 'experimental:params' element"},
           {"<empty/>", "<empty/><box/>", "1 further 'box' shape"},
           {"<state ", "<state><model name='lost'/></state><state ", ""},
           {"<deletions>", "<model name='lost'/><deletions>", "state of 'lost' (absent)"}}) {
    std::string world = kWorld;
    world.replace(world.find(from), from.size(), to);
    EXPECT_EQ(outcome(world).second, words) << to;
  }
}

}  // namespace
}  // namespace prospect::sdf_fields_test
