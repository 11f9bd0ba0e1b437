package org.magcomp.compose

import android.view.Surface
import androidx.compose.foundation.text.BasicText
import androidx.compose.runtime.CompositionLocalProvider
import androidx.compose.ui.test.ExperimentalTestApi
import androidx.compose.ui.test.hasText
import androidx.compose.ui.test.runDesktopComposeUiTest
import androidx.lifecycle.Lifecycle
import androidx.lifecycle.LifecycleOwner
import androidx.lifecycle.compose.LocalLifecycleOwner
import java.util.concurrent.CopyOnWriteArrayList
import java.util.concurrent.atomic.AtomicInteger
import kotlin.time.Duration.Companion.ZERO
import kotlinx.coroutines.channels.Channel
import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Test
import org.magcomp.Compass
import org.magcomp.CompassState
import org.magcomp.EventTaker
import org.magcomp.MagneticFieldSource
import org.magcomp.RawEvent
import org.magcomp.core.DeviceVector
import org.magcomp.core.MagneticSample
import org.magcomp.core.SensorSample

/** Over stand-ins of AndroidX. */
@OptIn(ExperimentalTestApi::class)
class RememberCompassTest {
    private val events = Channel<MagneticSample>(Channel.UNLIMITED)
    private val running = AtomicInteger()
    private val source = object : MagneticFieldSource {
        override suspend fun deliver(taker: EventTaker) {
            running.incrementAndGet()
            try {
                for (event in events) if (event.timeNs > 0) taker.take(RawEvent().set(SensorSample.Magnetic(event))) else error("broken")
            } finally {
                running.decrementAndGet()
            }
        }
    }

    private fun deliver(timeNs: Long) = events.trySend(MagneticSample(timeNs, DeviceVector(1.0, 2.0, timeNs.toDouble())))

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
}
