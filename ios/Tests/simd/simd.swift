// A stand-in of Apple's simd for tests on Linux: the declarations that the library uses, by Apple's public documentation.

public struct simd_float4x4: Sendable {
    public var columns: (SIMD4<Float>, SIMD4<Float>, SIMD4<Float>, SIMD4<Float>)

    public init(_ x: SIMD4<Float>, _ y: SIMD4<Float>, _ z: SIMD4<Float>, _ w: SIMD4<Float>) { columns = (x, y, z, w) }
}

public struct simd_quatd: Sendable {
    public var vector: SIMD4<Double>

    public init(ix: Double, iy: Double, iz: Double, r: Double) { vector = SIMD4(ix, iy, iz, r) }
}
