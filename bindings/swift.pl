# What uniffi writes for Swift, as an app should see it: `perl bindings/swift.pl FILE` changes the file.
# Apps share one namespace with Apple's frameworks and every package they use, so what serves this package alone (converters,
# global functions, the compensator over uniffi) is `package`, which SwiftPM shows to this package's targets and nobody else;
# cases of errors begin with a small letter, as Swift's do; documents use Swift's names.
use strict;
use warnings;

local $/;
open my $in, '<', $ARGV[0] or die "$ARGV[0]: $!\n";
my $text = <$in>;
close $in;

sub must { my ($what, $found) = @_; $found or die "bindings: uniffi writes $what no more; look at bindings/swift.pl\n" }

must 'public converters', $text =~ s/^public (struct|func) (?=FfiConverter)/fileprivate $1 /mg;
# a method's body does not call what begins with fn_func
must 'global functions', $text =~ s/^public (?=func (?:(?!^public ).)*?_fn_func_)/package /msg;
must 'the check of versions', $text =~ s/^public (?=func uniffiEnsure)/package /mg;
must 'NativeCompensator', $text =~ s/^(?:open class|public protocol) (?=NativeCompensator)/$& =~ m{class} ? 'package final class ' : 'package protocol '/mge;
must 'protocols of objects', $text =~ s/^public protocol /package protocol /mg;
must 'open classes', $text =~ s/^open class /public final class /mg;
must 'open methods', $text =~ s/^open func /public func /mg;
must 'initialisers from handles', $text =~ s/^    (?:required )?public (?=init\(unsafeFromHandle|init\(noHandle|struct NoHandle|func uniffiCloneHandle)/    package /mg;

# uniffi's own fault: a method of a renamed enum converts it by its old name
$text =~ s{^(public enum (\w+).*?)(?=^#if compiler)}{my ($body, $name) = ($1, $2); $body =~ s/FfiConverterType\w+_lower\(self\)/FfiConverterType${name}_lower(self)/g; $body}msge;

# what costs nothing to ask and changes nothing is a property
must 'text and label', $text =~ s/^public func (text|label)\(\) -> String  \{/public var $1: String  {/mg;
$text =~ s/`text\(\)` says it/`text` says it/g;

# the error's cases, where it is declared, read and written
$text =~ m/^enum MagcompError: .*?^fileprivate func FfiConverterTypeMagcompError_lift/ms or die "bindings: no MagcompError\n";
my ($from, $length) = ($-[0], $+[0] - $-[0]);
my $error = substr $text, $from, $length;
must 'capital cases of errors', $error =~ s/(^    case |return \.|case let \.|        case \.)([A-Z])/$1\l$2/mg;
substr($text, $from, $length) = $error;

# what uniffi.toml renames, in documents too where a field follows: `Config.initial`; alone, it may be an error's case
my ($lines) = do { local @ARGV = 'rust/magcomp-ffi/uniffi.toml'; <> } =~ /^\[bindings\.swift\.rename\]\n((?:(?!\[).*\n)*)/m;
my %names = $lines =~ /^(\w+) = "(\w+)"/mg;

# documents: `field_ut` is fieldUt, but for a path as an error says it; `KeptDamaged` is MagcompError.keptDamaged
my $errors = join '|', map { ucfirst } $error =~ /^    case (\w+)/mg;
$text =~ s{^(\s*\*\s.*)$}{
    my $line = $1;
    $line =~ s/`(?![a-z]\w*\.)([^`]*)`/my $name = $1; $name =~ s,(?<=[a-z0-9])_([a-z0-9]),\u$1,g; "`$name`"/ge;
    $line =~ s/`([A-Z]\w*)(?=\.[a-z])/"`" . ($names{$1} || $1)/ge;
    $line =~ s/\b(with|or|after|from|until) `($errors)`/$1 `MagcompError.\l$2`/g;
    $line
}mge;

open my $out, '>', $ARGV[0] or die "$ARGV[0]: $!\n";
print $out $text;
close $out;
