#!/usr/bin/python3
"""Writes a motion (CSV: t,x,y,z in s and m) as a bag of probe/pose.

Usage: csv_to_bag.py MOTION.csv OUT.bag"""
import csv
import sys

import rosbag
import rospy
from geometry_msgs.msg import PoseStamped

START = 1.0e9  # any time long ago [s]


def main(source, target):
    with open(source, newline="") as file, rosbag.Bag(target, "w") as bag:
        for row in csv.DictReader(file):
            pose = PoseStamped()
            pose.header.frame_id = "world"
            pose.header.stamp = rospy.Time.from_sec(START + float(row["t"]))
            pose.pose.position.x = float(row["x"])
            pose.pose.position.y = float(row["y"])
            pose.pose.position.z = float(row["z"])
            pose.pose.orientation.w = 1.0
            bag.write("probe/pose", pose, pose.header.stamp)


if __name__ == "__main__":
    main(*sys.argv[1:])
