#!/usr/bin/python3
"""Ends when the cloth has draped and a hand presses on it.

Usage: wait_for_press.py SIMULATED_SECONDS TIMEOUT [FORCE [WINDOW]]

Listens to every probe of the running node: all topics NAME/reaction. FORCE in newton, default 0.8. With WINDOW it ends
only in so many simulated seconds after SIMULATED_SECONDS, if need be after the next reset."""
import math
import sys
import time

if {"-h", "--help"} & set(sys.argv):
    print(__doc__)
    sys.exit(0)

import rospy
from geometry_msgs.msg import WrenchStamped
from haptic_cloth.msg import ClothState


def main(simulated, timeout, wanted=0.8, window=math.inf):
    rospy.init_node("wait_for_press", anonymous=True)
    seen = {"time": 0.0}
    forces = {}
    subscribers = {}
    rospy.Subscriber("cloth/state", ClothState, lambda message: seen.update(time=message.time))

    def listen():
        for topic, kind in rospy.get_published_topics():
            if kind == "geometry_msgs/WrenchStamped" and topic.endswith("/reaction") and topic not in subscribers:
                subscribers[topic] = rospy.Subscriber(
                    topic, WrenchStamped, lambda message, topic=topic: forces.update({topic: norm(message)}), queue_size=1)

    end = time.monotonic() + timeout
    look = 0.0
    while time.monotonic() < end and not rospy.is_shutdown():
        if time.monotonic() > look:
            listen()
            look = time.monotonic() + 1.0
        if 0.0 <= seen["time"] - simulated <= window and max(forces.values(), default=0.0) >= wanted:
            return 0
        time.sleep(0.005)
    print("no press within %g s: simulated %.2f s, forces %s" % (
        timeout, seen["time"], {topic: round(force, 2) for topic, force in sorted(forces.items())}))
    return 1


def norm(message):
    force = message.wrench.force
    return math.sqrt(force.x**2 + force.y**2 + force.z**2)


if __name__ == "__main__":
    sys.exit(main(*map(float, sys.argv[1:])))
