@file:JvmName("Recordings")

package org.magcomp

import android.os.Build
import java.io.File
import java.io.OutputStream
import java.util.zip.GZIPOutputStream
import kotlin.math.abs
import kotlinx.coroutines.Dispatchers
import kotlinx.coroutines.flow.firstOrNull
import kotlinx.coroutines.withContext

/**
 * Writes the raw events of a source to a file until it is cancelled, the source ends, or [mostBytes] are written. `magcomp replay` reads the
 * file, and [RecordingSource] plays it. A recording takes part in the sensors as any collector does, so it holds no compass up. A process
 * that is killed loses the last second.
 *
 * Every event is in the file. It has its own row, and the other sensors' cells are empty; events of the same time share a row. The columns:
 * - `t_s`: seconds since the first event, in the order in which a compass gets the events: each row's are more than those of the row before
 * - `own_t_s`: the event's own time, where it is another one because the event came late, or twice, or because its sensor has another clock
 *   than the magnetometer. Then `t_s` is on the magnetometer's clock, or a nanosecond after the row before while that is not made out
 * - `mx,my,mz`: the raw field, microtesla; `sys_mx,sys_my,sys_mz`: the field as the system corrects it, microtesla; `sys_accuracy`: how far
 *   the system trusts it, 0 (not at all) to 3 (high), empty where it has not said
 * - `ax,ay,az`: gravity or acceleration, m/s^2, pointing up at rest; `gx,gy,gz`: rad/s
 * - `about`: in the first row, the library's version, the phone's maker and model, its Android, and the sensors' names
 *
 * The file holds no place and no date.
 *
 * @param file a `.csv`, or a `.csv.gz`, which is a third as large. It may exist if it is empty
 * @param mostBytes the size of the unpacked text at which the file ends, at least 1000. Default 100 MB, about two hours at 100 Hz
 * @return how many events were written
 * @throws java.io.IOException when the file can't be written; what was written stays. It is a [FileAlreadyExistsException] when something
 *   was in the file
 */
public suspend fun MagneticFieldSource.record(file: File, mostBytes: Long = 100_000_000): Long = record(file, mostBytes, System::nanoTime)

internal suspend fun MagneticFieldSource.record(file: File, mostBytes: Long, nowNs: () -> Long): Long = withContext(Dispatchers.IO) {
    require(mostBytes >= 1000) { "mostBytes is $mostBytes, expected at least 1000" }
    if (file.length() > 0) throw FileAlreadyExistsException(file, reason = "there is something in it; give another name, or delete it")
    val bytes = file.outputStream().buffered()
    (if (file.name.endsWith(".gz")) GZIPOutputStream(bytes, PACKED, true) else bytes).use { out ->
        val rows = Rows(out, mostBytes, nowNs)
        // a phone's sensors may come more seldom, or late by what was asked for
        if (this@record is SensorManagerSource) rows.leadNs = mostBetweenNs
        try {
            var isFull = false
            fun write(event: RawEvent) {
                if (!isFull) isFull = !rows.write(event)
            }
            events({ rows.sensors = it }, ::write).firstOrNull {
                write(it)
                isFull
            }
        } finally {
            rows.end()
        }
        rows.events
    }
}

/** The rows of a recording, the one that is not complete yet aside. */
private class Rows(private val out: OutputStream, private val mostBytes: Long, private val nowNs: () -> Long) {
    /** Said in the first row. */
    @Volatile
    var sensors: SensorsInUse? = null

    /** How far an event of another sensor than the magnetometer may be after the row before, ns: beyond that its clock is another one. */
    var leadNs = 1_000_000_000L
    var events = 0L
        private set
    private var bytes = 0L
    private var flushedNs = nowNs()

    /** The first event's time, and what times of events now have more than those of rows. */
    private var zeroNs = 0L
    private var aheadNs = 0L

    /** The row's time since the first, and its events' own. */
    private var rowNs = -1L
    private var ownNs = 0L
    private val cells = EMPTY.copyOf()
    private var isEmpty = true
    private var isFirst = true

    init {
        line("t_s,own_t_s,mx,my,mz,sys_mx,sys_my,sys_mz,sys_accuracy,ax,ay,az,gx,gy,gz,about")
    }

    /** Whether there is room for more. */
    fun write(event: RawEvent): Boolean {
        if (events == 0L) {
            zeroNs = event.timeNs
            aheadNs = event.timeNs
        }
        val timeNs = placed(event)
        val eventOwnNs = event.ownNs - zeroNs
        if (timeNs != rowNs || eventOwnNs != ownNs || cells[event.kind] != EMPTY[event.kind]) {
            if (!isEmpty) row()
            rowNs = maxOf(timeNs, rowNs + 1)
            ownNs = eventOwnNs
        }
        cells[event.kind] = text(event.x, event.y, event.z)
        if (event.kind == RawEvent.MAGNETIC) {
            event.reportedHardIronUt?.let { cells[SYSTEM] = text(event.x - it.x, event.y - it.y, event.z - it.z) }
            cells[ACCURACY] = accuracy(event.accuracy)
        }
        isEmpty = false
        events += 1
        return bytes < mostBytes - LONGEST_ROW
    }

    /** The time of an event among the rows: at most at the row's where it is not after that. */
    private fun placed(event: RawEvent): Long {
        // in doubles: any two times may be subtracted
        val behindNs = rowNs + aheadNs.toDouble() - event.timeNs.toDouble()
        if (event.kind == RawEvent.MAGNETIC) {
            // times began anew: the rows go on
            if (behindNs > leadNs) aheadNs = event.timeNs - rowNs - 1
        } else if (abs(behindNs) > leadNs) {
            return rowNs + 1
        }
        return event.timeNs - aheadNs
    }

    fun end() {
        if (!isEmpty) row()
    }

    private fun row() {
        val own = if (ownNs == rowNs) "" else seconds(ownNs)
        line("${seconds(rowNs)},$own,${ORDER.joinToString(",") { cells[it] }},${if (isFirst) about() else ""}")
        isFirst = false
        EMPTY.copyInto(cells)
        isEmpty = true
        if (nowNs() - flushedNs < FLUSH_NS) return
        out.flush()
        flushedNs = nowNs()
    }

    private fun about(): String {
        val used = sensors?.run {
            listOf(magnetometer to "magnetometer", up to "up", gyroscope to "gyroscope")
                .mapNotNull { (sensor, name) -> sensor?.let { "$name ${it.name} of ${it.vendor}" } }
        }
        val all = listOf("magcomp $VERSION", "${Build.MANUFACTURER} ${Build.MODEL}, Android ${Build.VERSION.RELEASE}") + used.orEmpty()
        return "\"${all.joinToString("; ").filter { it in ' '..'~' }.take(LONGEST_ABOUT).replace("\"", "\"\"")}\""
    }

    /** As a phone's sensors measure, in floats. */
    private fun text(x: Double, y: Double, z: Double) = "${x.toFloat()},${y.toFloat()},${z.toFloat()}"

    private fun line(text: String) {
        val line = "$text\n".toByteArray()
        out.write(line)
        bytes += line.size
    }

    private companion object {
        // beside RawEvent's ROTATION_RATE, UP and MAGNETIC
        const val SYSTEM = 3
        const val ACCURACY = 4

        /** Cells of each, without an event, and their order in a row. */
        val EMPTY = arrayOf(",,", ",,", ",,", ",,", "")
        val ORDER = intArrayOf(RawEvent.MAGNETIC, SYSTEM, ACCURACY, RawEvent.UP, RawEvent.ROTATION_RATE)
        const val FLUSH_NS = 1_000_000_000L

        const val LONGEST_ABOUT = 250

        /** 15 numbers, two of them times. For the first, which says more, there always is room. */
        const val LONGEST_ROW = 300

        /** In whole nanoseconds: a double would round. */
        fun seconds(ns: Long): String {
            val whole = abs(ns / NS)
            return "${if (ns < 0) "-" else ""}$whole.${abs(ns % NS).toString().padStart(9, '0')}"
        }

        fun accuracy(accuracy: SensorAccuracy) = when (accuracy) {
            SensorAccuracy.UNKNOWN -> ""
            SensorAccuracy.NO_CONTACT, SensorAccuracy.UNRELIABLE -> "0"
            SensorAccuracy.LOW -> "1"
            SensorAccuracy.MEDIUM -> "2"
            SensorAccuracy.HIGH -> "3"
        }

        const val NS = 1_000_000_000L
    }
}

/** The library's. */
internal const val VERSION: String = "0.1.0"

/** Of gzip's own buffer, bytes. */
private const val PACKED = 512
