#!/usr/bin/python3
"""Ends when the cloth has draped and the hand presses on it. Usage: wait_for_press.py SIMULATED_SECONDS TIMEOUT"""
import sys
import time

import rospy
from geometry_msgs.msg import WrenchStamped
from haptic_cloth.msg import ClothState


def main(simulated, timeout):
    rospy.init_node("wait_for_press", anonymous=True)
    seen = {"time": 0.0, "force": 0.0}
    rospy.Subscriber("cloth/state", ClothState, lambda message: seen.update(time=message.time))
    rospy.Subscriber("probe/reaction", WrenchStamped, lambda message: seen.update(force=message.wrench.force.z),
                     queue_size=1)
    end = time.monotonic() + timeout
    while time.monotonic() < end and not rospy.is_shutdown():
        if seen["time"] >= simulated and seen["force"] > 0.8:
            return 0
        time.sleep(0.005)
    print("no press within %g s: simulated %.2f s, force %.2f N" % (timeout, seen["time"], seen["force"]))
    return 1


if __name__ == "__main__":
    sys.exit(main(float(sys.argv[1]), float(sys.argv[2])))
