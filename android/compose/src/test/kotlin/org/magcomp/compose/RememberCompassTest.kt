package org.magcomp.compose

import android.view.Surface
import androidx.compose.foundation.text.BasicText
import androidx.compose.runtime.CompositionLocalProvider
import androidx.compose.runtime.getValue
import androidx.compose.runtime.mutableStateOf
import androidx.compose.runtime.setValue
import androidx.compose.ui.test.ExperimentalTestApi
import androidx.compose.ui.test.hasText
import androidx.compose.ui.test.runDesktopComposeUiTest
import androidx.lifecycle.Lifecycle
import androidx.lifecycle.LifecycleOwner
import androidx.lifecycle.compose.LocalLifecycleOwner
import java.util.concurrent.CopyOnWriteArrayList
import java.util.concurrent.atomic.AtomicInteger
import kotlin.math.roundToInt
import kotlin.time.Duration.Companion.ZERO
import kotlinx.coroutines.channels.Channel
import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Test
import org.magcomp.Compass
import org.magcomp.CompassState
import org.magcomp.EventTaker
import org.magcomp.MagneticFieldSource
import org.magcomp.RawEvent
import org.magcomp.core.*

/** Over stand-ins of AndroidX. */
@OptIn(ExperimentalTestApi::class)
class RememberCompassTest {
    private val events = Channel<SensorSample>(Channel.UNLIMITED)
    private val running = AtomicInteger()
    private val source = object : MagneticFieldSource {
        override suspend fun deliver(taker: EventTaker) {
            running.incrementAndGet()
            try {
                for (event in events) if (event.timeNs > 0) taker.take(RawEvent().set(event)) else error("broken")
            } finally {
                running.decrementAndGet()
            }
        }
    }

    /** Of a phone whose top edge points north and whose back camera points east. */
    private fun deliver(timeNs: Long) {
        events.trySend(SensorSample.Up(UpSample(timeNs, DeviceVector(5.886, 0.0, 7.848))))
        events.trySend(SensorSample.Magnetic(MagneticSample(timeNs, DeviceVector(-27.0, 20.0, -36.0 + 1e-3 * (timeNs % 97)))))
    }

    /** Without a hard iron. */
    private val known = MagnetometerCalibration(SoftIron(1.0, 1.0, 1.0, 0.0, 0.0, 0.0), DeviceVector(0.0, 0.0, 0.0), 49.244)

    @Test
    fun `a screen shows readings while it is on, and an error`() = runDesktopComposeUiTest {
        val screen = object : LifecycleOwner {
            override val lifecycle = Lifecycle()
        }
        val compass = Compass(source, grace = ZERO)
        var rotation = Surface.ROTATION_90
        val asked = CopyOnWriteArrayList<Int>()
        setContent {
            CompositionLocalProvider(LocalLifecycleOwner provides screen) {
                val state = rememberCompass(compass) { rotation.also(asked::add) }.value
                val ended = state as? CompassState.Ended
                BasicText("time ${(state as? CompassState.Live)?.reading?.timeNs}, error ${if (ended == null) null else ended.error?.message ?: "none"}")
            }
        }
        fun shown(text: String) = waitUntil(20_000) { onAllNodes(hasText(text)).fetchSemanticsNodes().isNotEmpty() }
        shown("time null, error null")
        assertEquals(0, running.get(), "the screen is off")
        screen.lifecycle.state.value = Lifecycle.State.STARTED
        deliver(1)
        shown("time 1, error null")
        assertEquals(Surface.ROTATION_90, asked.last())
        rotation = Surface.ROTATION_270
        deliver(2)
        shown("time 2, error null")
        assertEquals(Surface.ROTATION_270, asked.last())

        screen.lifecycle.state.value = Lifecycle.State.CREATED
        waitUntil(20_000) { running.get() == 0 }
        shown("time 2, error null")
        screen.lifecycle.state.value = Lifecycle.State.STARTED
        deliver(3)
        shown("time 3, error null")
        deliver(-1)
        shown("time null, error broken")
    }

    @Test
    fun `a screen may ask for another axis, and ask its rotation in another way`() = runDesktopComposeUiTest {
        val screen = object : LifecycleOwner {
            override val lifecycle = Lifecycle().apply { state.value = Lifecycle.State.STARTED }
        }
        val compass = Compass(source, CompensationConfig(initial = known))
        var axis by mutableStateOf(ReferenceAxis.CAMERA)
        var rotation by mutableStateOf({ Surface.ROTATION_0 })
        setContent {
            CompositionLocalProvider(LocalLifecycleOwner provides screen) {
                BasicText("heading ${(rememberCompass(compass, axis, rotation).value as? CompassState.Live)?.reading?.headingDeg?.roundToInt()?.mod(360)}")
            }
        }
        var timeNs = 0L
        fun shown(text: String) = waitUntil(20_000) {
            timeNs += 10_000_000
            deliver(timeNs)
            onAllNodes(hasText(text)).fetchSemanticsNodes().isNotEmpty()
        }
        shown("heading 90")
        axis = ReferenceAxis.TOP_EDGE
        shown("heading 0")
        rotation = { Surface.ROTATION_90 }
        shown("heading 90")
        compass.close()
    }
}
