package org.magcomp.readme

import kotlinx.coroutines.flow.Flow
import kotlinx.coroutines.flow.mapNotNull
import org.magcomp.Compass
import org.magcomp.Orientation
import org.magcomp.screenRotation

// what follows is in android/MIGRATION.md; ReadmeTest compares them
/** What `getOrientation` answered after `remapCoordinateSystem` for the turned screen, in degrees. */
fun orientations(compass: Compass, rotation: () -> Int): Flow<Orientation> =
    compass.headings { screenRotation(rotation()) }.mapNotNull { it.orientation }

/** What `onSensorChanged` got of `TYPE_ROTATION_VECTOR`: x, y, z, w, and the accuracy in radians, -1 where it is not known. */
fun rotationVectors(compass: Compass): Flow<FloatArray> = compass.headings().mapNotNull { reading ->
    val attitude = reading.attitude ?: return@mapNotNull null
    val accuracy = reading.headingSigmaDeg?.let(Math::toRadians) ?: -1.0
    with(attitude) { doubleArrayOf(x, y, z, w, accuracy) }.map { it.toFloat() }.toFloatArray()
}
