import Magcomp
import Testing

@Test func smoke() throws {
    #expect(try Compensator().push(MagneticSample(timeNs: 1, fieldUt: Vector3(x: 1, y: 2, z: 3))).timeNs == 1)
}
