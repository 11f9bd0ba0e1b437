from setuptools import setup

setup(
    name="magcomp_ros",
    version="0.1.0",
    packages=["magcomp_ros"],
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/magcomp_ros"]),
        ("share/magcomp_ros", ["package.xml"]),
        ("share/magcomp_ros/launch", ["launch/compass.launch.xml"]),
        ("share/magcomp_ros/config", ["config/compass.yaml"]),
    ],
    install_requires=["setuptools", "magcomp"],
    license="MIT OR Apache-2.0",
    entry_points={"console_scripts": ["compass = magcomp_ros.node:main"]},
)
