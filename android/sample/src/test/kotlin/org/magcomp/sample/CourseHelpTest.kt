package org.magcomp.sample

import android.location.Location
import android.location.LocationListener
import kotlin.math.sin
import kotlinx.coroutines.flow.flow
import kotlinx.coroutines.flow.toList
import kotlinx.coroutines.runBlocking
import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Assertions.assertTrue
import org.junit.jupiter.api.Test
import org.magcomp.MagnetometerCalibration
import org.magcomp.Compass
import org.magcomp.CompensationConfig
import org.magcomp.HeadingAid
import org.magcomp.MagneticFieldSource
import org.magcomp.MagneticSample
import org.magcomp.RotationRateSample
import org.magcomp.SensorSample
import org.magcomp.SoftIron
import org.magcomp.UpSample
import org.magcomp.DeviceVector

class CourseHelpTest {
    @Test
    fun `fixes of a walk lead, one that can't be is passed over`() = runBlocking {
        lateinit var compass: Compass
        lateinit var help: CourseHelp
        val source = object : MagneticFieldSource {
            override fun samples() = flow {
                for (k in 1L..3000) {
                    val ns = k * 20_000_000
                    fun at(latitudeDeg: Double) = Location("a test").apply {
                        latitude = latitudeDeg
                        longitude = 13.4
                        time = 1_750_000_000_000
                        elapsedRealtimeNanos = ns
                        bearing = 30f
                        speed = 1.4f
                        bearingAccuracyDegrees = 5f
                    }
                    if (k % 50 == 0L) help.onLocationChanged(at(52.5))
                    if (k % 100 == 0L) help.onLocationChanged(at(91.0))
                    emit(SensorSample.RotationRate(RotationRateSample(ns, DeviceVector(0.0, 0.0, 0.0))))
                    emit(SensorSample.Up(UpSample(ns, DeviceVector(0.0, 0.0, 9.81))))
                    emit(SensorSample.Magnetic(MagneticSample(ns, DeviceVector(0.2 * sin(k.toDouble()), 20.0, -45.0))))
                }
            }
        }
        val field = MagnetometerCalibration(SoftIron(1.0, 1.0, 1.0, 0.0, 0.0, 0.0), DeviceVector(0.0, 0.0, 0.0), 49.244)
        compass = Compass(source, CompensationConfig(initial = field, initialSigmaUt = 30.0), graceMs = 0)
        help = CourseHelp(compass)
        val last = compass.readings().toList().last()
        assertEquals(HeadingAid.LEADS, last.headingAid)
        assertEquals(30.0, last.reading.heading!!.trueHeadingDeg!!, 8.0)
        assertTrue(compass.declinationDeg!! in 3.0..7.0, "${compass.declinationDeg}")
        compass.close()
        // after it nothing of the system's callbacks may throw
        help.onLocationChanged(Location("a test"))
    }

    @Test
    fun `Androids before version 11 find a body for each of their calls`() {
        for (method in LocationListener::class.java.methods.filter { it.name in setOf("onProviderEnabled", "onProviderDisabled", "onStatusChanged") }) {
            CourseHelp::class.java.getDeclaredMethod(method.name, *method.parameterTypes)
        }
    }
}
