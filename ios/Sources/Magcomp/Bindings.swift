@_exported import MagcompBindings

import Foundation

extension MagcompError: LocalizedError {
    /// The error in a sentence that says what to do.
    public var errorDescription: String? { text() }
}
