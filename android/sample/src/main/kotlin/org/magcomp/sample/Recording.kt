package org.magcomp.sample

import android.content.res.Resources
import java.io.File
import java.text.SimpleDateFormat
import java.util.Date
import java.util.Locale
import kotlinx.coroutines.CancellationException
import kotlinx.coroutines.CoroutineScope
import kotlinx.coroutines.Job
import kotlinx.coroutines.flow.MutableStateFlow
import kotlinx.coroutines.flow.StateFlow
import kotlinx.coroutines.launch
import org.magcomp.Compass

/** Whether a recording goes on, and what came of it, in words; [file]: the latest that is whole. */
data class RecordingState(val isOn: Boolean, val text: String, val file: File? = null)

/** Records the raw events of the compass's sensors into a folder, for `magcomp replay`, until it is told to stop. */
class Recording(private val compass: Compass, private val folder: File?, private val scope: CoroutineScope, private val resources: Resources) {
    private val told = MutableStateFlow(RecordingState(false, resources.getString(R.string.record_off)))
    private var job: Job? = null

    val state: StateFlow<RecordingState> = told

    fun set(isWanted: Boolean) {
        if (isWanted == told.value.isOn) return
        if (!isWanted) {
            job?.cancel()
            return
        }
        val file = File(folder, "magcomp-${SimpleDateFormat("yyyyMMdd-HHmmss", Locale.ROOT).format(Date())}.csv.gz")
        told.value = RecordingState(true, say(R.string.record_on, file.path))
        job = scope.launch {
            try {
                compass.record(file)
                told.value = RecordingState(false, say(R.string.recorded, file.path), file)
            } catch (e: CancellationException) {
                told.value = RecordingState(false, say(R.string.recorded, file.path), file)
                throw e
            } catch (e: Exception) {
                // no room, no sensor
                told.value = RecordingState(false, say(R.string.not_recorded, e.message ?: "$e"))
            }
        }
    }

    private fun say(id: Int, value: String): String = resources.getString(id, value)
}
