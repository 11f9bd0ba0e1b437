# What uniffi writes, as an app should see it: `perl bindings/uniffi.pl kotlin|swift FILE` changes the file. uniffi.toml renames types; what
# it has no setting for is here, and an upgrade of uniffi that writes otherwise is an error that says what is missing.
# * What serves the library alone (converters, buffers, handles, the compensator over uniffi) is hidden: `internal` in Kotlin; in Swift, where
#   apps share one namespace with every package they use, `package`, which SwiftPM shows to this package's targets and nobody else.
# * Documents have the names of the language and of uniffi.toml. An error's message is its sentence.
# * Swift: cases of errors begin with a small letter, as Swift's do; what costs nothing to ask is a property; counts are `Int`; objects have
#   `close()`. What research needs and no app is SPI: it takes `@_spi(Research) import Magcomp`. What belongs to one type stands in it.
use strict;
use warnings;

my ($language, $file) = @ARGV;
local $/;
sub content { my ($path) = @_; open my $in, '<', $path or die "$path: $!\n"; return scalar <$in> }
my $text = content($file);

sub must { my ($what, $found) = @_; $found or die "bindings: uniffi writes $what no more; look at bindings/uniffi.pl\n" }

# in documents too, where a field follows: `Config.initial`; alone, it may be an error's case
my ($lines) = content('rust/magcomp-ffi/uniffi.toml') =~ /^\[bindings\.$language\.rename\]\n((?:(?!\[).*\n)*)/m;
my %names = $lines =~ /^(\w+) = "(\w+)"/mg;
my ($nested) = content('rust/magcomp-ffi/uniffi.toml') =~ /^\[swift\.nested\]\n((?:(?!\[).*\n)*)/m;
my %nested = $nested =~ /^(\w+) = "([\w.]+)"/mg;

# `field_ut` is fieldUt, but for a path as an error says it
sub document {
    my ($part) = @_;
    $part =~ s/`(?![a-z]\w*\.)([^`]*)`/my $name = $1; $name =~ s,(?<=[a-z0-9])_([a-z0-9]),\u$1,g; "`$name`"/ge;
    $part =~ s/`([A-Z]\w*)(?=\.[a-z])/"`" . ($names{$1} || $1)/ge;
    return $part;
}

sub kotlin {
    must 'public converters', $text =~ s/^public (?=(?:object|interface) FfiConverter)/internal /mg;
    must 'RustBuffer', $text =~ s/^(?=open class RustBuffer\b)/internal /mg;
    for my $name (qw(InternalException UniffiRustCallStatusErrorHandler UniffiNullRustCallStatusErrorHandler Disposable UniffiWithHandle NoHandle UniffiCleaner)) {
        must $name, $text =~ s/^(?=(?:class|interface|object) $name\b)/internal /mg;
    }
    must 'use of what is disposed of', $text =~ s/^(?=inline fun <T : Disposable)/internal /mg;
    must 'the check of versions', $text =~ s/^public (?=fun uniffiEnsure)/internal /mg;
    must 'interfaces of objects', $text =~ s/^public (?=interface Native)/internal /mg;
    must 'objects', $text =~ s/^(?=open class Native)/internal /mg;
    must 'the reader of errors', $text =~ s/^( +)(?=companion object ErrorHandler)/$1internal /mg;

    # uniffi's own fault: a method of a renamed enum converts it by its old name
    $text =~ s/\bFfiConverterType(\w+)(?=\.lower\(this\))/"FfiConverterType" . ($names{$1} || $1)/ge;

    # a value that is missing is null
    $text =~ s{(/\*\*.*?\*/)}{
        my $document = document($1);
        $document =~ s/\bNone(?=[\s*]+(?:where|while|before|without|when|until|for)\b|: (?:not known|no true))/Null/g;
        $document =~ s/\bDefault none\b/Default null/g;
        $document
    }gsex;

    # uniffi lists the fields
    must 'messages', $text =~ s/^( +override val message\n +get\(\) = )(".*")$/$1sentence($2)/mg;

    # cases without fields say their names
    must 'objects as cases', $text =~ s/^    (?=object \w+ : \w+\(\)$)/    data /mg;

    # nobody asks for those that are empty, but for the cleaner's
    must 'companions', $text =~ s/(interface UniffiCleaner \{.*?companion object\n)|^ *companion object\n/$1 \/\/ ''/msge;
    must 'its functions', $text =~ s/^(?=package )/\@file:JvmName("Magcomp")\n\n/m;
    must 'its errors', $text =~ s/^(sealed class MagcompException): kotlin\.Exception\(\)/$1: org.magcomp.CompassException()/m;

    # every call asks for the library first: Java would tell a class that fails to load twice, in two ways, neither of them ours
    must 'calls', $text =~ s/^(private inline fun <U, E: kotlin\.Exception> uniffiRustCallWithError\(.*\{\n)/$1    NativeLibrary.check()\n/m;
}

# The paper's method, its fits, and the settings that a compass knows better.
sub research {
    return qw(CompensationMethod ConstantField DirectionCoverage EllipsoidFit FitOptions FitResidual FitTermination HeadingConfig ModelOrder
        SensorMode SigmaNormalisation SoftIron WindowedConfig);
}

# Rust refuses what is too large by the range of the setting.
sub counts { return <<'SWIFT' }
fileprivate struct FfiConverterInt32: FfiConverter {
    typealias FfiType = Int32
    typealias SwiftType = Int

    public static func lift(_ value: Int32) throws -> Int { Int(value) }

    public static func lower(_ value: Int) -> Int32 { Int32(clamping: value) }

    public static func read(from buf: inout (data: Data, offset: Data.Index)) throws -> Int { try lift(readInt(&buf)) }

    public static func write(_ value: Int, into buf: inout [UInt8]) { writeInt(&buf, lower(value)) }
}
SWIFT

sub swift {
    must 'public converters', $text =~ s/^public (struct|func) (?=FfiConverter)/fileprivate $1 /mg;
    # a method's body does not call what begins with fn_func
    must 'global functions', $text =~ s/^public (?=func (?:(?!^public ).)*?_fn_func_)/package /msg;
    must 'the check of versions', $text =~ s/^public (?=func uniffiEnsure)/package /mg;
    must 'NativeCompensator', $text =~ s/^(?:open class|public protocol) (?=NativeCompensator)/$& =~ m{class} ? 'package final class ' : 'package protocol '/mge;
    must 'protocols of objects', $text =~ s/^public protocol /package protocol /mg;
    must 'open classes', $text =~ s/^open class /public final class /mg;
    must 'open methods', $text =~ s/^open func /public func /mg;
    must 'initialisers from handles', $text =~ s/^    (?:required )?public (?=init\(unsafeFromHandle|init\(noHandle|struct NoHandle|func uniffiCloneHandle)/    package /mg;

    # the same fault
    $text =~ s{^(public enum (\w+).*?)(?=^#if compiler)}{my ($body, $name) = ($1, $2); $body =~ s/FfiConverterType\w+_lower\(self\)/FfiConverterType${name}_lower(self)/g; $body}msge;

    must 'the converter of counts', $text =~ s/^fileprivate struct FfiConverterInt32: FfiConverterPrimitive \{.*?^\}\n/counts()/mse;
    must 'counts', $text =~ s/^(    public var \w+: |.*\*\/\w+: |    typealias SwiftType = )Int32(?=\?? *(?:$|[,)=]))/$1Int/mg;
    must 'methods of counts', $text =~ s/^( *(?:public |convenience )*(?:func|init)\b.*)\bInt32\b/$1Int/mg;
    must 'ends', $text =~ s/^(.*func )shutDown\(/$1close(/mg;

    my $research = join '|', research();
    must 'research', $text =~ s/^(?=public (?:struct|enum|final class) (?:$research)\b|extension (?:$research)\b)/\@_spi(Research) /mg;
    must 'properties of research', $text =~ s/^    (?=public var \w+: (?:$research)\b)/    \@_spi(Research) /mg;
    my $numbers = join '|', qw(filteredFieldUt sigmaT window directionSigmaDeg worstSigmaDeg reportedHardIronJumpUt);
    must 'numbers for research', $text =~ s/^    (?=public var (?:$numbers): )/    \@_spi(Research) /mg;
    must 'initialisers', $text =~ s{^    (public init\(\n.*?\) \{)}{
        my $made = $1;
        ($made =~ m{\*/\w+: (?:$research)\b} ? "    \@_spi(Research) " : "    ") . $made
    }msge;

    must 'text and label', $text =~ s/^public func (text|label)\(\) -> String  \{/public var $1: String  {/mg;
    $text =~ s/`text\(\)` says it/`text` says it/g;

    # the error's cases, where it is declared, read and written
    $text =~ m/^enum MagcompError: .*?^fileprivate func FfiConverterTypeMagcompError_lift/ms or die "bindings: no MagcompError\n";
    my ($from, $length) = ($-[0], $+[0] - $-[0]);
    my $error = substr $text, $from, $length;
    must 'capital cases of errors', $error =~ s/(^    case |return \.|case let \.|        case \.)([A-Z])/$1\l$2/mg;
    substr($text, $from, $length) = $error;

    # `KeptDamaged` is MagcompError.keptDamaged
    my $errors = join '|', map { ucfirst } $error =~ /^    case (\w+)/mg;
    $text =~ s{^(\s*\*\s.*)$}{
        my $line = document($1);
        $line =~ s/\b(with|or|after|from|until) `($errors)`/$1 `MagcompError.\l$2`/g;
        $line
    }mge;

    for my $name (sort keys %nested) {
        my ($owner, $own) = $nested{$name} =~ /(.*)\.(\w+)/;
        must $name, $text =~ s{^(/\*\*\n(?: \*[^\n]*\n)+\n?(?:\@_spi\(Research\) )?public (?:struct|enum) )$name\b(.*?\n\}\n)}{
            my $made = "$1$own$2";
            $made =~ s/^(?=.)/    /mg;
            "extension $owner {\n$made}\n"
        }mse;
        $text =~ s/(?<!struct )(?<!enum )\b$name\b/$nested{$name}/g;
    }
}

$language eq 'kotlin' ? kotlin() : $language eq 'swift' ? swift() : die "usage: bindings/uniffi.pl kotlin|swift FILE\n";
open my $out, '>', $file or die "$file: $!\n";
print $out $text;
close $out or die "$file: $!\n";
