package org.magcomp

import android.content.Context
import android.location.Location
import java.io.File
import java.util.concurrent.Executor
import java.util.concurrent.LinkedBlockingQueue
import java.util.concurrent.ThreadPoolExecutor
import java.util.concurrent.TimeUnit
import kotlin.time.Duration
import kotlin.time.Duration.Companion.milliseconds
import kotlin.time.Duration.Companion.seconds
import kotlinx.coroutines.CoroutineDispatcher
import kotlinx.coroutines.CoroutineScope
import kotlinx.coroutines.Dispatchers
import kotlinx.coroutines.SupervisorJob
import kotlinx.coroutines.asCoroutineDispatcher
import kotlinx.coroutines.currentCoroutineContext
import kotlinx.coroutines.flow.Flow
import kotlinx.coroutines.flow.catch
import kotlinx.coroutines.flow.firstOrNull
import kotlinx.coroutines.flow.map
import kotlinx.coroutines.flow.onCompletion
import kotlinx.coroutines.flow.onEach
import kotlinx.coroutines.flow.onStart
import kotlinx.coroutines.job
import kotlinx.coroutines.withTimeoutOrNull
import org.magcomp.core.*

/**
 * A compass of the phone's own sensors: `Compass(context).headings().collect { ... }`.
 *
 * An app keeps one `Compass` for its whole life, or in a `ViewModel`. All collectors share one estimator, which keeps the calibration it has
 * learned. The phone's sensors are registered once. A second `Compass` of the same source has its own estimator and shares the sensors. The
 * estimator runs on a thread that does nothing else, so no work of the app holds it up. What belongs to a screen, its rotation and the
 * heading's axis, each collector says for itself.
 *
 * @param source where events come from
 * @param config a field that is left out has the library's default, as in [Compensator]. Two defaults serve a compass. The heading's axis is
 *   `AUTO`, which does not flip when the phone is raised. With `useReportedHardIron` the system's own hard iron is the first calibration where
 *   there is no other, so the first reading has a heading with a wide sigma. A config without `railUt` gets the source's
 *   [MagneticFieldSource.fullScaleUt]
 * @param store where the calibration is kept from one launch to the next; null keeps it nowhere. No reading waits for the store: a calibration
 *   that takes longer than 0.1 s to load is taken over when it comes, unless the estimator has learned a better one meanwhile
 * @param grace how long the sensors go on after the last collector has left, 0 or above. A screen that is turned comes back within this time
 *   and finds everything running. Default 5 s
 */
public class Compass internal constructor(
    private val source: MagneticFieldSource,
    private val config: CompensationConfig,
    private val store: CalibrationStore?,
    grace: Duration,
    dispatcher: CoroutineDispatcher,
    stores: CoroutineDispatcher = Dispatchers.IO,
) : AutoCloseable {
    /** A compass of any source. */
    public constructor(
        source: MagneticFieldSource,
        config: CompensationConfig = CompensationConfig(),
        store: CalibrationStore? = null,
        grace: Duration = 5.seconds,
    ) : this(source, config, store, grace, threadsOfItsOwn())

    /** A compass of a source, for Java. [create] takes the other parameters too. */
    public constructor(source: MagneticFieldSource) : this(source, CompensationConfig())

    /**
     * A compass of the phone's sensors, which keeps its calibration in the app's preferences ([PreferencesStore]).
     *
     * @param context any context of the app. The compass keeps the application's context alone
     * @param options how the sensors are asked. The default asks for 100 Hz
     * @param config as above
     */
    @JvmOverloads
    public constructor(context: Context, options: SensorOptions = SensorOptions(), config: CompensationConfig = CompensationConfig()) :
        this(SensorManagerSource(context, options), config, PreferencesStore(context))

    init {
        require(grace >= Duration.ZERO) { "grace is $grace, expected 0 or above" }
    }

    private val frame = config.headingFrame()

    /** The estimation, kept from one run to the next. Only one run goes on at a time. */
    @Volatile
    internal var kept: Estimation? = null
        private set
    private val shared = SharedReadings(dispatcher, grace, onIdle = { kept?.end() }, onEnd = { kept?.settled() }, { source.nowNs }, ::run)

    /** Where the store is called. */
    private val stores = CoroutineScope(stores + SupervisorJob())

    /**
     * The declination of the place for a true heading, degrees, east positive, -180 to 180; [geomagneticField] gives it. A declination out of
     * range throws [MagcompException.Config] and changes nothing.
     */
    @Volatile
    public var declinationDeg: Double? = frame.declinationDeg
        @Throws(MagcompException::class)
        set(wanted) {
            checkDeclination(wanted)
            field = wanted
        }

    /**
     * Every reading, whole, for a file or a computation; [headings] and [states] are for a screen. Each magnetometer sample makes one reading,
     * and a magnetometer that falls silent makes one more ([CompensatedReading.stream]). A new collector gets the latest reading at once if
     * that is less than a second old and others collect them whole. A collector may be [MOST_WAITING] readings behind. One that falls further
     * behind loses the oldest, and [CompensatedReading.droppedBefore] counts them. The heading is that of the config's frame;
     * [CompensatedReading.headingOn] has the others.
     *
     * The sensors run from the first collector on until the last has left and the grace time has passed. The compass saves the calibration
     * when the status is first `Tracking`, then when the calibration has changed and 10 s have passed since the last save, when the last
     * collector leaves (a screen's `onStop`), and when the sensors are released.
     *
     * An error of the source ends the flow of every collector, after the readings before it. The next collector begins a new run, and the
     * estimator goes on where it was. If the events' times begin more than a second earlier than they ended, as those of a recording do, the
     * estimator keeps its calibration alone.
     */
    public fun readings(): Flow<CompensatedReading> = shared.whole()

    /**
     * The readings for a screen: a collector that is slower than they are gets the latest alone, and a new one gets it at once if it is less
     * than a second old.
     *
     * @param axis the axis of the device that the headings belong to; null: that of the config, which is `AUTO` unless it says another
     * @param rotation how far the screen has turned, which the collector asks with every reading: `{ screenRotation(display.rotation) }`, as a
     *   screen that turns upside down restarts no activity; null: that of the config, which is 0 unless it says another
     */
    @JvmOverloads
    public fun headings(axis: ReferenceAxis? = null, rotation: (() -> ScreenRotation)? = null): Flow<CompassReading> =
        shared.latest { it.on(axis, rotation) }

    private fun Answer.on(axis: ReferenceAxis?, rotation: (() -> ScreenRotation)?) =
        CompassReading(this, axis ?: frame.axis, rotation?.invoke() ?: frame.screenRotation)

    /**
     * The [headings] as states, for a screen that shows one: [CompassState.Waiting] first, then the latest reading, and at last that the
     * readings have ended and why. It throws no error of the source. `states().stateIn(viewModelScope, ...)` makes a `StateFlow` of it.
     */
    @JvmOverloads
    public fun states(axis: ReferenceAxis? = null, rotation: (() -> ScreenRotation)? = null): Flow<CompassState> =
        headings(axis, rotation).map<CompassReading, CompassState> { CompassState.Live(it) }
            .onStart { emit(CompassState.Waiting) }
            .onCompletion { if (it == null) emit(CompassState.Ended(if (shared.isClosed) MagcompException.Closed() else null)) }
            // an Error, which nobody would catch, would end the app
            .catch { emit(CompassState.Ended(it.asException())) }

    /**
     * One heading: the first reading whose heading is as sure as asked for. If none comes in time, this gives the latest reading, whose
     * [CompassReading.text] says why, or null if no reading came. It throws an error of the source.
     *
     * @param within how long it may take, above 0
     * @param worstSigmaDeg the largest standard deviation that will do, degrees, above 0
     * @param axis as in [headings]
     * @param rotation as in [headings]
     */
    public suspend fun heading(
        within: Duration = 5.seconds,
        worstSigmaDeg: Double = 180.0,
        axis: ReferenceAxis? = null,
        rotation: (() -> ScreenRotation)? = null,
    ): CompassReading? {
        require(within > Duration.ZERO) { "within is $within, expected above 0" }
        require(worstSigmaDeg > 0) { "worstSigmaDeg is $worstSigmaDeg, expected above 0" }
        var latest: CompassReading? = null
        val found = withTimeoutOrNull(within) {
            headings(axis, rotation).onEach { latest = it }.firstOrNull { (it.headingSigmaDeg ?: return@firstOrNull false) <= worstSigmaDeg }
        }
        return found ?: latest
    }

    /** Writes the raw events of this compass's source to a file; [MagneticFieldSource.record] has the details. */
    public suspend fun record(file: File, mostBytes: Long = 100_000_000): Long = source.record(file, mostBytes)

    /**
     * Tells the compass where the phone is, for a true heading: it sets [declinationDeg] by [geomagneticField]. The app needs a permission for
     * the place, and none for the sensors. A place without a date counts as one of now. A date outside the model's years is no error, nor is
     * a height that can't be.
     *
     * @throws MagcompException.Place when the latitude or longitude is out of range; the declination stays as it was
     */
    @Throws(MagcompException::class)
    public fun setPlace(place: Location) {
        val heightM = if (place.hasAltitude() && place.altitude in LOWEST_M..HIGHEST_M) place.altitude else 0.0
        val timeMs = place.time.takeIf { it > 0 } ?: (1000 * unixTimeS())
        declinationDeg = geomagneticField(place.latitude, place.longitude, heightM, timeMs).declinationDeg
    }

    /**
     * Takes help from outside: the course of a GNSS fix. In a car, or among magnets, a course tells the Earth's north from the place's. A fix
     * tells no course without bearing or speed, below 3 m/s in a vehicle and below 0.7 m/s on foot. The course's sigma is
     * `bearingAccuracyDegrees` (else 0.5 m/s across the course) together with 2 degrees in a vehicle, and 10 on foot for how the phone is
     * held. Any thread may call this.
     *
     * @param headed what moves along that course: [HeadedAxis.Vehicle] while the phone lies in a holder, whose angle is learned; [HELD_AHEAD] while
     *   a walker holds it ahead; another direction of the device where the app knows it. While none of these is true, do not call this
     * @return whether the course was taken. If not, the fix tells none, came too late, or nobody collects readings; nothing has changed
     */
    @Throws(MagcompException::class)
    public fun aid(place: Location, headed: HeadedAxis): Boolean {
        val course = courseOf(place, headed) ?: return aiding { false }
        return aid(course)
    }

    /**
     * Takes help from outside: a heading that the app knows, such as that of a landmark or a corridor.
     *
     * @param heading with a time by `SystemClock.elapsedRealtimeNanos()`, at most 5 s ago
     * @return whether the heading was taken. If not, it came too late or twice, or nobody collects readings; nothing has changed
     * @throws MagcompException.EventRejected when a number is not finite or out of range; nothing has changed then
     */
    @Throws(MagcompException::class)
    public fun aid(heading: HeadingSample): Boolean {
        check(heading)
        return aiding { pushHeading(heading.copy(timeNs = source.eventTimeNs(heading.timeNs))) }
    }

    /**
     * Takes help from outside: how the phone is turned, as a camera sees it ([arCoreAttitude]). Its turns stand in for a missing gyroscope. An
     * attitude whose yaw is known is a heading too.
     *
     * @param attitude with a time by `SystemClock.elapsedRealtimeNanos()`
     * @return whether the attitude was taken, as above
     * @throws MagcompException.EventRejected when a number is not finite or out of range; nothing has changed then
     */
    @Throws(MagcompException::class)
    public fun aid(attitude: AttitudeSample): Boolean {
        check(attitude)
        return aiding { pushAttitude(attitude.copy(timeNs = source.eventTimeNs(attitude.timeNs))) }
    }

    /** The declination that true headings from outside have shown; null before the first of them and while [declinationDeg] is set. */
    @Throws(MagcompException::class)
    public fun foundDeclination(): FoundDeclination? {
        if (shared.isClosed) throw MagcompException.Closed()
        return kept?.compensator?.foundDeclination()
    }

    private fun aiding(push: Compensator.() -> Boolean): Boolean {
        if (shared.isClosed) throw MagcompException.Closed()
        // a run that has ended keeps its estimator
        return shared.isCollected && kept?.aid(push) ?: false
    }

    /** Seconds since 1970, for the date of what is kept. */
    internal var unixTimeS: () -> Long = ::systemUnixTimeS

    private fun configOfSource() = if (config.railUt != null) config else config.copy(railUt = source.fullScaleUt)

    private suspend fun run(to: Told) {
        val estimation = kept ?: Estimation(configOfSource(), store, { declinationDeg }, source, unixTimeS, stores).also { kept = it }
        try {
            estimation.settled(LOAD_WAIT_MS)
            estimation.begin(to, currentCoroutineContext().job)
            try {
                source.deliver(estimation)
            } finally {
                estimation.end()
            }
        } catch (e: MagcompException) {
            // after a defect another begins
            kept = null
            estimation.close()
            throw e
        }
    }

    /**
     * Every reading, for Java. The compass calls [listener] on [executor], one call at a time, until the handle is closed. An exception that
     * `onReading` throws ends the readings, as every other error does, and goes to `onEnd`.
     */
    public fun start(executor: Executor, listener: CompassReadingListener): CompassHandle =
        listening(executor, { _, error -> listener.onEnd(error) }) {
            shared.whole(isBrief = true).collect { executor.call { listener.onReading(it) } }
        }

    /**
     * The readings for a screen, for Java: a listener that is slower than they are gets the latest alone.
     *
     * @param axis as in [headings]
     * @param rotation as in [headings]; [executor] asks it
     */
    @JvmOverloads
    public fun start(
        executor: Executor,
        listener: HeadingListener,
        axis: ReferenceAxis? = null,
        rotation: (() -> ScreenRotation)? = null,
    ): CompassHandle = listening(executor, { _, error -> listener.onEnd(error) }) {
        shared.latest(isBrief = true) { it }.collect { executor.call { listener.onHeading(it.on(axis, rotation)) } }
    }

    /**
     * One heading, for Java: the same as the other `heading`.
     *
     * @param withinMs how long it may take, milliseconds, above 0
     * @param worstSigmaDeg the largest standard deviation that will do, degrees, above 0
     */
    public fun heading(withinMs: Long, worstSigmaDeg: Double, executor: Executor, callback: HeadingCallback): CompassHandle =
        listening(executor, callback::onHeading) { heading(withinMs.milliseconds, worstSigmaDeg) }

    /** Records as the other `record`, for Java, until the handle is closed, the source ends, or 100 MB are written. */
    public fun record(file: File, executor: Executor, callback: RecordingCallback): CompassHandle =
        listening(executor, { _, error -> callback.onEnd(file, error) }, isToldOfClosing = true) { record(file) }

    /**
     * Ends the readings of every collector. In the background it releases the sensors, saves the calibration and frees the estimator.
     * Collecting afterwards throws [MagcompException.Closed]. The garbage collector frees a compass that nobody closed.
     */
    override fun close() {
        shared.close {
            kept?.close()
            kept = null
        }
    }

    /** Functions and constants that need no compass. */
    public companion object {
        /** Readings that wait for a slow collector of [readings]: 80 s at 100 Hz, about 6 MB. */
        public const val MOST_WAITING: Int = 8192

        /**
         * A compass for Java, whose constructors can't take a `Duration`.
         *
         * @param graceMs how long the sensors go on after the last listener has left, milliseconds, 0 or above
         */
        @JvmStatic
        public fun create(source: MagneticFieldSource, config: CompensationConfig, store: CalibrationStore?, graceMs: Long): Compass =
            Compass(source, config, store, graceMs.milliseconds)

        /**
         * Begins to load the native library in the background and returns at once. Otherwise the first call waits for it, 0.1 s or more. Any
         * thread may call this, the main thread too, any number of times. If loading fails, the first call says so.
         */
        @JvmStatic
        public fun preload() {
            Thread({ runCatching { NativeLibrary.check() } }, "magcomp preload").start()
        }

        /** How long a run waits for a store before it goes on without. */
        private const val LOAD_WAIT_MS = 100L

        /** How long a thread of a compass waits for more work before it ends, s. */
        private const val IDLE_S = 5L

        /**
         * Runs begin and end there, so that no other work of the app holds them up. A source that never waits takes one thread, and the other
         * ends it.
         */
        private fun threadsOfItsOwn(): CoroutineDispatcher =
            ThreadPoolExecutor(2, 2, IDLE_S, TimeUnit.SECONDS, LinkedBlockingQueue()) { Thread(it, "magcomp compass").apply { isDaemon = true } }
                .apply { allowCoreThreadTimeOut(true) }
                .asCoroutineDispatcher()

        // what the model serves
        private const val LOWEST_M = -1000.0
        private const val HIGHEST_M = 850_000.0
    }
}

/** The core's own range, held together with it by a test: asking it would build an estimator on the caller's thread. */
private fun checkDeclination(declinationDeg: Double?) {
    if (declinationDeg != null && declinationDeg !in -180.0..180.0) {
        throw MagcompException.Config("heading.declination_deg", "$declinationDeg", "-180.0 to 180.0 deg, or none")
    }
}
