package org.magcomp.sample

import android.Manifest
import android.location.Location
import android.location.LocationListener
import java.io.File
import kotlin.math.sin
import kotlin.time.Duration.Companion.ZERO
import kotlinx.coroutines.flow.toList
import kotlinx.coroutines.runBlocking
import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Assertions.assertTrue
import org.junit.jupiter.api.Test
import org.magcomp.Compass
import org.magcomp.EventTaker
import org.magcomp.MagneticFieldSource
import org.magcomp.RawEvent
import org.magcomp.core.CompensationConfig
import org.magcomp.core.DeviceVector
import org.magcomp.core.HeadingAid
import org.magcomp.core.MagneticSample
import org.magcomp.core.MagnetometerCalibration
import org.magcomp.core.RotationRateSample
import org.magcomp.core.SensorSample
import org.magcomp.core.SoftIron
import org.magcomp.core.UpSample

class CourseHelpTest {
    @Test
    fun `fixes of a walk lead, one that can't be is passed over`() = runBlocking {
        lateinit var compass: Compass
        lateinit var help: CourseHelp
        val source = object : MagneticFieldSource {
            override suspend fun deliver(taker: EventTaker) {
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
                    taker.take(RawEvent().set(SensorSample.RotationRate(RotationRateSample(ns, DeviceVector(0.0, 0.0, 0.0)))))
                    taker.take(RawEvent().set(SensorSample.Up(UpSample(ns, DeviceVector(0.0, 0.0, 9.81)))))
                    taker.take(RawEvent().set(SensorSample.Magnetic(MagneticSample(ns, DeviceVector(0.2 * sin(k.toDouble()), 20.0, -45.0)))))
                }
            }
        }
        val field = MagnetometerCalibration(SoftIron(1.0, 1.0, 1.0, 0.0, 0.0, 0.0), DeviceVector(0.0, 0.0, 0.0), 49.244)
        compass = Compass(source, CompensationConfig(initial = field, initialSigmaUt = 30.0), grace = ZERO)
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
    fun `the precise place is asked for together with the approximate one, which alone has no course`() {
        val (fine, coarse) = Pair(Manifest.permission.ACCESS_FINE_LOCATION, Manifest.permission.ACCESS_COARSE_LOCATION)
        assertEquals(setOf(fine, coarse), CourseHelp.PERMISSIONS.toSet())
        val sample = File(System.getProperty("repository.root"), "android/sample/src")
        val declared = Regex("uses-permission android:name=\"([^\"]*)\"").findAll(sample.resolve("main/AndroidManifest.xml").readText())
        assertEquals(setOf(fine, coarse), declared.map { it.groupValues[1] }.toSet())
        val answers = listOf(mapOf(fine to true, coarse to true), mapOf(fine to false, coarse to true), mapOf(fine to false, coarse to false), emptyMap())
        assertEquals(listOf(true, false, false, false), answers.map(CourseHelp::isAllowed))
        // the activity, which is compiled in Android Studio alone, asks so
        val activity = sample.resolve("activity/kotlin/org/magcomp/sample/CompassActivity.kt").readText()
        assertTrue("RequestMultiplePermissions()" in activity && "asked.launch(CourseHelp.PERMISSIONS)" in activity)
    }

    @Test
    fun `Androids before version 11 find a body for each of their calls`() {
        for (method in LocationListener::class.java.methods.filter { it.name in setOf("onProviderEnabled", "onProviderDisabled", "onStatusChanged") }) {
            CourseHelp::class.java.getDeclaredMethod(method.name, *method.parameterTypes)
        }
    }
}
