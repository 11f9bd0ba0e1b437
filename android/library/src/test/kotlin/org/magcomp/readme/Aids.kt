package org.magcomp.readme

import android.location.Location
import android.os.SystemClock
import org.magcomp.Compass
import org.magcomp.HELD_AHEAD
import org.magcomp.arCoreAttitude
import org.magcomp.core.DeviceVector
import org.magcomp.core.HeadedAxis
import org.magcomp.core.HeadingSample
import org.magcomp.core.NorthReference

// what follows is in android/GUIDE.md; ReadmeTest compares them
/** In a car the phone lies in a holder; who walks holds it ahead. The app or its user says which; where neither is true, no course helps. */
fun onFix(compass: Compass, fix: Location, isInHolder: Boolean) {
    compass.setPlace(fix)
    compass.aid(fix, if (isInHolder) HeadedAxis.Vehicle else HELD_AHEAD)
}

/** Of ARCore's frame `androidCameraTimestamp` and `androidSensorPose.rotationQuaternion`, while its camera is tracking. */
fun onFrame(compass: Compass, timestampNs: Long, rotation: FloatArray) {
    compass.aid(arCoreAttitude(timestampNs, rotation))
}

/** The user points the camera at a landmark, to 5 degrees; the map knows where it is from here. */
fun onLandmark(compass: Compass, bearingDeg: Double) {
    val camera = HeadedAxis.Device(DeviceVector(0.0, 0.0, -1.0))
    compass.aid(HeadingSample(SystemClock.elapsedRealtimeNanos(), bearingDeg, 5.0, NorthReference.TRUE, camera))
}
