@file:JvmName("Aids")

package org.magcomp

import android.location.Location
import android.os.Build
import kotlin.math.abs
import kotlin.math.atan2
import kotlin.math.hypot
import kotlin.math.sqrt
import org.magcomp.core.*

/**
 * The direction of the phone that points ahead while a walker holds it, for [Compass.aid]. It lies between top edge and back camera, so it
 * points ahead whether the phone lies in the hand or is held up.
 */
@JvmField
public val HELD_AHEAD: HeadedAxis = HeadedAxis.Device(DeviceVector(0.0, 1.0, -1.0))

/**
 * Makes a pose of ARCore, whose world has a y axis that points up, an attitude for [Compass.aid]. `frame.androidSensorPose.rotationQuaternion`
 * is a pose of the device's own frame, however the screen is turned. `earth.getGeospatialPose(frame.androidSensorPose).eastUpSouthQuaternion`
 * has a known yaw.
 *
 * @param elapsedRealtimeNs the pose's time by `SystemClock.elapsedRealtimeNanos()`
 * @param rotation its quaternion as ARCore gives it: x, y, z, w
 * @param yawSigmaDeg one standard deviation of its yaw against true north, degrees, `orientationYawAccuracy`. With null its world may be turned
 *   to anywhere, and its turns alone count
 */
@JvmOverloads
public fun arCoreAttitude(elapsedRealtimeNs: Long, rotation: FloatArray, yawSigmaDeg: Double? = null): AttitudeSample {
    require(rotation.size == 4) { "rotation has ${rotation.size} numbers, expected x, y, z, w" }
    val (x, y, z, w) = rotation.map { it.toDouble() }
    val yaw = yawSigmaDeg?.let { WorldYaw.Absolute(it, NorthReference.TRUE) } ?: WorldYaw.Relative
    // (x, y, z) of that world is (x, -z, y) of one whose z points up: a quarter turn about x
    val half = sqrt(0.5)
    return AttitudeSample(elapsedRealtimeNs, half * (w - x), half * (x + w), half * (y - z), half * (z + y), yaw)
}

/** The course of a fix as a heading; null where it says nothing: without bearing or speed, or too slow. */
internal fun courseOf(place: Location, headed: HeadedAxis): HeadingSample? {
    val leastMS = if (headed is HeadedAxis.Vehicle) DRIVING_M_S else WALKING_M_S
    val speedMS = place.speed.toDouble()
    if (!place.hasBearing() || !place.hasSpeed() || !(speedMS >= leastMS)) return null
    val toldDeg = toldSigmaDeg(place) ?: Math.toDegrees(atan2(SPEED_SIGMA_M_S, speedMS))
    val sigmaDeg = hypot(toldDeg, if (headed is HeadedAxis.Vehicle) TRACK_SIGMA_DEG else HELD_SIGMA_DEG)
    return HeadingSample(place.elapsedRealtimeNanos, place.bearing.toDouble(), minOf(sigmaDeg, MOST_SIGMA_DEG), NorthReference.TRUE, headed)
}

/** 0 is what some phones tell where they know nothing. */
@NewerThanMinSdk
private fun toldSigmaDeg(place: Location): Double? {
    if (Build.VERSION.SDK_INT < Build.VERSION_CODES.O || !place.hasBearingAccuracy()) return null
    return place.bearingAccuracyDegrees.toDouble().takeIf { it > 0 }
}

/** The core's own ranges, held together with it by a test: a sample may be refused before there is an estimator. */
internal fun check(sample: HeadingSample) = with(sample) {
    val numbers = listOf(headingDeg, sigmaDeg) + ((axis as? HeadedAxis.Device)?.axis?.run { listOf(x, y, z) } ?: listOf(1.0))
    refuseUnless(numbers.all { it.isFinite() }, EventRejection.NOT_FINITE)
    refuseUnless(sigmaDeg > 0 && sigmaDeg <= MOST_SIGMA_DEG && abs(headingDeg) <= 360 && numbers.drop(2).any { it != 0.0 }, EventRejection.OUT_OF_RANGE)
}

/** The same of an attitude. */
internal fun check(sample: AttitudeSample) = with(sample) {
    val sigmaDeg = (yaw as? WorldYaw.Absolute)?.sigmaDeg ?: MOST_SIGMA_DEG
    refuseUnless(listOf(w, x, y, z, sigmaDeg).all { it.isFinite() }, EventRejection.NOT_FINITE)
    refuseUnless(listOf(w, x, y, z).any { it != 0.0 } && sigmaDeg > 0 && sigmaDeg <= MOST_SIGMA_DEG, EventRejection.OUT_OF_RANGE)
}

private fun refuseUnless(isFit: Boolean, reason: EventRejection) {
    if (!isFit) throw MagcompException.EventRejected(reason)
}

/** Marks what asks for the version of Android before it calls what minSdk does not have: the build's check passes over it. */
@Retention(AnnotationRetention.BINARY)
@Target(AnnotationTarget.FUNCTION)
internal annotation class NewerThanMinSdk

/** Choice: a car that goes more slowly may go backwards. */
private const val DRIVING_M_S = 3.0

/** Choice: who goes more slowly stands and looks about. */
private const val WALKING_M_S = 0.7

/** Choice: the error of a GNSS speed across the course, where the phone tells none. */
private const val SPEED_SIGMA_M_S = 0.5

/** Choice: how far off ahead a phone is held, and a car's nose off its track. */
private const val HELD_SIGMA_DEG = 10.0
private const val TRACK_SIGMA_DEG = 2.0
private const val MOST_SIGMA_DEG = 180.0
