# SPDX-License-Identifier: Apache-2.0
"""Starts the relay beside the motors and the mission: prospect must be on the PATH.

The launch ends when the mission does, and the mission when the relay does not come up again.
"""
import os
import time

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, ExecuteProcess, SetEnvironmentVariable, Shutdown
from launch.conditions import IfCondition
from launch.substitutions import LaunchConfiguration


def generate_launch_description():
    package = get_package_share_directory("prospect_robot")
    config = os.path.join(package, "config")
    robot = LaunchConfiguration("robot")
    # What both programs take as nodes of ROS 2 do.
    names = ["--ros-args", "-r", ["__ns:=", LaunchConfiguration("namespace")],
             "-p", ["use_sim_time:=", LaunchConfiguration("use_sim_time")]]
    return LaunchDescription([
        DeclareLaunchArgument("robot", default_value=os.path.join(config, "robot.yaml"),
                              description="topics, frames and dead-man of the robot"),
        DeclareLaunchArgument("mission", default_value=os.path.join(config, "mission.yaml"),
                              description="configuration of the mission"),
        DeclareLaunchArgument("namespace", default_value="/", description="of the robot: /robot"),
        DeclareLaunchArgument("use_sim_time", default_value="false", description="time of /clock"),
        DeclareLaunchArgument("out", default_value=time.strftime("runs/robot_%Y%m%d_%H%M%S"),
                              description="folder of the run"),
        DeclareLaunchArgument("rviz", default_value="false", description="start RViz, too"),
        # For the nodes of ROS 2 that are launched beside these: images arrive whole, and services
        # of Prospect answer.
        SetEnvironmentVariable("RMW_IMPLEMENTATION", "rmw_cyclonedds_cpp"),
        SetEnvironmentVariable("CYCLONEDDS_URI", "file://" + os.path.join(config, "cyclonedds.xml")),
        ExecuteProcess(cmd=["prospect", "relay", "--ros", robot, *names], output="screen",
                       respawn=True),
        ExecuteProcess(cmd=["prospect", "drive", "--config", LaunchConfiguration("mission"),
                            "--base", "dds", "--ros", robot, "--out", LaunchConfiguration("out"),
                            *names],
                       output="screen", on_exit=[Shutdown(reason="the mission is over")]),
        ExecuteProcess(cmd=["rviz2", "-d", os.path.join(package, "rviz", "prospect.rviz")],
                       condition=IfCondition(LaunchConfiguration("rviz"))),
    ])
