package org.magcomp

import kotlinx.coroutines.flow.Flow

/** Where events come from: a phone's sensors ([SensorManagerSource]), a recording ([RecordingSource]), or your own. */
public interface MagneticFieldSource {
    /**
     * The events, each sensor's in the order of their times. Cold: every collector starts its own, and ends it by
     * cancelling. No event may be dropped on the way.
     */
    public fun samples(): Flow<SensorSample>
}
