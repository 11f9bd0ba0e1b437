package org.magcomp

import kotlinx.coroutines.runBlocking
import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Assertions.assertThrows
import org.junit.jupiter.api.Test

class InboxTest {
    private val event = RawEvent()

    private fun Inbox.put(timeNs: Long) = take(event.apply { set(RawEvent.UP, timeNs, 1.0, 2.0, 3.0) })

    @Test
    fun `what comes before the collector waits, copied, though the event is used again`() = runBlocking {
        val inbox = Inbox(most = 5000)
        for (k in 1L..5000) inbox.put(k)
        for (k in 1L..5000) assertEquals(SensorSample.Up(UpSample(k, DeviceVector(1.0, 2.0, 3.0))), inbox.samples.receive())
    }

    @Test
    fun `one too many is an error, which comes after those that have waited`(): Unit = runBlocking {
        val inbox = Inbox(most = 3)
        for (k in 1L..3) inbox.put(k)
        val error = assertThrows(SensorException.NotTaken::class.java) { inbox.put(4) }
        assertEquals(3, error.events)
        inbox.failed(error)
        for (k in 1L..3) assertEquals(k, inbox.samples.receive().timeNs)
        assertThrows(SensorException.NotTaken::class.java) { runBlocking { inbox.samples.receive() } }
    }
}
