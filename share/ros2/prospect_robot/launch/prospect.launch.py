"""Starts the relay beside the motors and the mission: prospect must be on the PATH."""
import os

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, ExecuteProcess, SetEnvironmentVariable
from launch.substitutions import LaunchConfiguration


def generate_launch_description():
    config = os.path.join(get_package_share_directory("prospect_robot"), "config")
    robot = LaunchConfiguration("robot")
    return LaunchDescription([
        DeclareLaunchArgument("robot", default_value=os.path.join(config, "robot.yaml"),
                              description="topics, frames and dead-man of the robot"),
        DeclareLaunchArgument("mission", default_value=os.path.join(config, "mission.yaml"),
                              description="configuration of the mission"),
        # For the nodes of ROS 2 that are launched beside these: images arrive whole.
        SetEnvironmentVariable("RMW_IMPLEMENTATION", "rmw_cyclonedds_cpp"),
        SetEnvironmentVariable("CYCLONEDDS_URI", "file://" + os.path.join(config, "cyclonedds.xml")),
        ExecuteProcess(cmd=["prospect", "relay", "--ros", robot], output="screen", respawn=True),
        ExecuteProcess(cmd=["prospect", "drive", "--config", LaunchConfiguration("mission"),
                            "--base", "dds", "--ros", robot], output="screen"),
    ])
