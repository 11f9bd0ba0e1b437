package io.flutter.plugin.common

/** As much of Flutter as docs/FRAMEWORKS.md uses. */
class EventChannel {
    interface EventSink {
        fun success(event: Any?)
    }

    interface StreamHandler {
        fun onListen(arguments: Any?, events: EventSink)

        fun onCancel(arguments: Any?)
    }
}
