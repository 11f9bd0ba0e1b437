package org.magcomp

import android.content.Context
import java.util.concurrent.Executor
import kotlinx.coroutines.CoroutineScope
import kotlinx.coroutines.SupervisorJob
import kotlinx.coroutines.asCoroutineDispatcher
import kotlinx.coroutines.cancel
import kotlinx.coroutines.ensureActive
import kotlinx.coroutines.flow.Flow
import kotlinx.coroutines.flow.MutableStateFlow
import kotlinx.coroutines.launch

/**
 * A compass from a phone's own sensors: `Compass(context).readings().collect { ... }`.
 *
 * @param source where events come from
 * @param config what was left out is the library's default, but for the heading's axis: `AUTO`, which does not flip when the
 *   phone is raised
 * @param store where the calibration is kept from one launch to the next; null: nowhere
 */
public class Compass @JvmOverloads constructor(
    private val source: MagneticFieldSource,
    private val config: Config = Config(),
    private val store: CalibrationStore? = null,
) {
    /** The phone's sensors at 100 Hz, the calibration kept in the app's preferences. */
    public constructor(context: Context) : this(SensorManagerSource(context), Config(), PreferencesStore(context))

    private val frames = MutableStateFlow(
        HeadingFrame(
            config.heading?.axis ?: ReferenceAxis.AUTO,
            config.heading?.screenRotation ?: ScreenRotation.DEG0,
            config.heading?.declinationDeg,
        ),
    )

    /**
     * The frame headings are in; may be set at any time, from any thread, for instance when the screen was turned. With a
     * declination out of range readings end with [MagcompException.Config].
     */
    public var frame: HeadingFrame by frames::value

    /** One reading for every magnetometer sample, as long as it is collected. */
    public fun readings(): Flow<CompensatedReading> = source.samples().compensated(config, store, frames)

    /**
     * Readings for Java: [listener] is called on [executor], one call at a time, until the answer is closed. What the
     * listener throws in `onReading` ends the readings, as every other error does, and is given to its `onEnd`.
     *
     * @return closing it ends the readings; a call under way is finished
     */
    public fun start(executor: Executor, listener: CompassListener): AutoCloseable {
        val scope = CoroutineScope(SupervisorJob() + executor.asCoroutineDispatcher())
        scope.launch {
            // whoever threw it: nobody above this coroutine would hear of it before the app crashed
            val error = try {
                readings().collect { listener.onReading(it) }
                null
            } catch (e: Exception) {
                e
            }
            // after closing there is nobody to tell
            ensureActive()
            listener.onEnd(error)
        }
        return AutoCloseable { scope.cancel() }
    }
}

/** What a Java app implements to get readings. */
public interface CompassListener {
    /** One reading. */
    public fun onReading(reading: CompensatedReading)

    /**
     * There are no more readings, because the source ended or for this error: a [SensorException], a
     * [RecordingException], a [java.io.IOException] of a recording's file, a [MagcompException], or what the source, the
     * store or [onReading] threw. The sensors are no longer used then. Not called after closing.
     */
    public fun onEnd(error: Exception?)
}
